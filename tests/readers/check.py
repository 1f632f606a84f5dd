"""Files that other software wrote, read by shakedown and by that software, value by value.

    python3 tests/readers/check.py [DATA]

Needs numpy, scipy, h5py, npTDMS and obspy; what is missing is said and left out. Ends with status 1 where a value differs by more
than rounding. `cargo build -p shakedown --example columns` comes first, and this calls it.
"""

import csv
import importlib
import io
import math
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COLUMNS = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug" / "examples" / "columns"
RELATIVE = 1e-12


def library(name):
    """A library, or nothing, said plainly, where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"SKIPPED: {name} is not installed")
        return None


def columns(path, *more):
    """What shakedown reads: a list of values by column."""
    done = subprocess.run([COLUMNS, path, *more], capture_output=True, text=True)
    if done.returncode != 0:
        raise ValueError(f"{path}: {done.stderr.strip()}")
    rows = list(csv.reader(io.StringIO(done.stdout)))
    return {name: [float(r[i]) for r in rows[1:] if r[i] != ""] for i, name in enumerate(rows[0])}


def worst(found, wanted):
    """Largest difference over the largest magnitude; infinite where the lengths differ."""
    found, wanted = list(map(float, found)), list(map(float, wanted))
    if len(found) != len(wanted):
        return math.inf
    size = max((abs(w) for w in wanted if math.isfinite(w)), default=0.0) or 1.0
    apart = lambda a, b: 0.0 if math.isnan(a) and math.isnan(b) else abs(a - b)
    return max((apart(a, b) for a, b in zip(found, wanted)), default=0.0) / size


class Bench:
    """Comparisons, and how many failed."""

    def __init__(self):
        self.failed, self.made = 0, 0

    def same(self, what, found, wanted, bound=RELATIVE):
        self.made += 1
        apart = worst(found, wanted)
        ok = apart <= bound
        self.failed += not ok
        print(f"{'same' if ok else 'DIFFERS'}: {what}: {len(list(wanted))} values, {apart:.1e} apart")

    def guarded(self, what, work):
        """One comparison that cannot be made is one failure and not the end."""
        try:
            work()
        except Exception as error:  # noqa: BLE001
            self.failed += 1
            print(f"FAILED: {what}: {error}")


def wave(numpy, count=3000, rate=200.0):
    t = numpy.arange(count) / rate
    return t, 12.5 * numpy.sin(7 * t) * numpy.exp(-0.1 * t), 0.3 * numpy.cos(31 * t)


def hdf5(bench, folder, numpy):
    h5py = library("h5py")
    if not h5py:
        return
    t, x, a = wave(numpy)
    path = folder / "chunked.h5"
    with h5py.File(path, "w") as f:
        f.create_dataset("time", data=t)
        f.create_dataset("run/x", data=x, chunks=(128,), compression="gzip", shuffle=True).attrs["unit"] = "mm"
        f.create_dataset("run/a", data=a.astype("f4"), chunks=(500,), fletcher32=True)
        f.create_dataset("run/both", data=numpy.stack([x, a], 1), chunks=(100, 1), compression="lzf")
        f.create_dataset("run/counts", data=(1000 * x).astype(">i2"), chunks=(64,))
    got = columns(path)
    with h5py.File(path) as f:
        for name in ["time", "run/x", "run/a", "run/counts"]:
            bench.same(f"chunked HDF5 {name}", got[name.replace("/", ".")], f[name][()])
        for k in (0, 1):
            bench.same(f"chunked HDF5 run/both, column {k + 1}", got[f"run.both(:;{k + 1})"], f["run/both"][:, k])


def tdms(bench, folder, numpy, data):
    nptdms = library("nptdms")
    if not nptdms:
        return
    t, x, a = wave(numpy)
    path = folder / "made.tdms"
    with nptdms.TdmsWriter(path) as writer:
        for part in (slice(0, 1000), slice(1000, 3000)):
            made = [
                nptdms.ChannelObject("run", "x", x[part], {"wf_increment": 0.005, "unit_string": "mm"}),
                nptdms.ChannelObject("run", "a", a[part].astype("f4"), {"wf_increment": 0.005}),
            ]
            writer.write_segment(made)
    for path in [path, *sorted((data / "files").glob("*.tdms"))]:
        got = columns(path)
        for group in nptdms.TdmsFile.read(path).groups():
            for channel in group.channels():
                if len(channel) and numpy.issubdtype(channel[:].dtype, numpy.number):
                    name = channel.name if channel.name in got else f"{group.name}/{channel.name}"
                    bench.same(f"TDMS {path.name} {name}", got[name], channel[:])


def matlab(bench, folder, numpy, data):
    scipy = library("scipy.io")
    if not scipy:
        return
    t, x, a = wave(numpy)
    path = folder / "made.mat"
    scipy.savemat(path, {"t": t, "x": x, "both": numpy.stack([x, a], 1)}, do_compression=True, oned_as="column")
    for path, names in [
        (path, ["t", "x"]),
        (data / "recordings/emps/DATA_EMPS.mat", ["t", "qg", "qm", "vir"]),
        (data / "recordings/emps/DATA_EMPS_PULSES.mat", ["t", "qm", "pulses_N"]),
        (data / "recordings/coupled_drives/drive.mat", ["u1", "z1"]),
    ]:
        if path.exists():
            got, want = columns(path), scipy.loadmat(path)
            for name in names:
                bench.same(f"MATLAB {path.name} {name}", got[name], want[name].ravel())


def miniseed(bench, folder, numpy):
    obspy = library("obspy")
    if not obspy:
        return
    _, x, a = wave(numpy)
    counts = (1000 * x).astype("int32")
    for encoding, values in [("STEIM2", counts), ("STEIM1", counts), ("INT32", counts), ("FLOAT32", x.astype("float32")), ("FLOAT64", a)]:
        for order in (">", "<"):
            header = {"network": "XX", "station": "TAB", "location": "00", "channel": "HNE", "sampling_rate": 200.0}
            path = folder / f"{encoding}{'b' if order == '>' else 'l'}.mseed"
            obspy.Trace(values, header).write(str(path), format="MSEED", encoding=encoding, reclen=512, byteorder=order)
            want = obspy.read(str(path))[0].data
            bench.same(f"miniSEED {encoding} {order}", columns(path)["XX.TAB.00.HNE"], want)


def text(bench, folder, numpy):
    t, x, a = wave(numpy, 400)
    rows = "".join(f"{k / 200:.3f}\t{u:.6f}\t{v:.6f}\r\n" for k, (u, v) in enumerate(zip(x, a)))
    want = [round(float(u), 6) for u in x]
    for name, encoding in [("utf16le", "utf-16-le"), ("utf16be", "utf-16-be")]:
        path = folder / f"{name}.txt"
        mark = b"\xff\xfe" if encoding.endswith("le") else b"\xfe\xff"
        path.write_bytes(mark + ("time [s]\tLVDT [mm]\tacc [g]\r\n" + rows).encode(encoding))
        bench.same(f"text in {encoding}", columns(path)["LVDT [mm]"], want)
    head = (
        "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\nDecimal_Separator\t,\r\n"
        "Multi_Headings\tNo\r\nX_Columns\tOne\r\nTime_Pref\tRelative\r\n***End_of_Header***\t\r\n\t\r\nChannels\t2\t\r\n"
        "Samples\t400\t400\t\r\nY_Unit_Label\tmm\tg\t\r\nX_Dimension\tTime\tTime\t\r\nX0\t0,0E+0\t0,0E+0\t\r\n"
        "Delta_X\t0,005\t0,005\t\r\n***End_of_Header***\t\t\t\r\nX_Value\tLVDT\tacc\tComment\r\n"
    )
    path = folder / "made.lvm"
    path.write_bytes((head + rows.replace(".", ",")).encode("cp1252"))
    got = columns(path)
    name = next((n for n in got if n.startswith("LVDT")), None)
    bench.same("LabVIEW .lvm", got.get(name, []), want)
    catman = "catman ASCII-Export\r\nDatum: 24.11.2026\r\nAbtastrate: 200 Hz\r\n\r\nZeit\tWeg\tBeschleunigung\r\ns\tmm\tg\r\n"
    path = folder / "catman.asc"
    path.write_bytes((catman + rows.replace(".", ",")).encode("cp1252"))
    got = columns(path)
    bench.same("text as catman exports it", next((v for n, v in got.items() if n.startswith("Weg")), []), want)


def rpc(bench, folder, numpy, data):
    """Big-endian RPC III as the format's description has it; and the sample against its own statistics."""
    _, x, _ = wave(numpy, 2048)
    raw = numpy.round(x / 12.5 * 32752).astype(">i2")
    keys = [
        ("FORMAT", "BINARY_IEEE_BIG_END"), ("NUM_HEADER_BLOCKS", "5"), ("NUM_PARAMS", "18"), ("FILE_TYPE", "TIME_HISTORY"),
        ("TIME_TYPE", "RESPONSE"), ("DELTA_T", "5.000000E-003"), ("CHANNELS", "1"), ("PTS_PER_FRAME", "1024"),
        ("PTS_PER_GROUP", "2048"), ("FRAMES", "2"), ("DATA_TYPE", "SHORT_INTEGER"), ("INT_FULL_SCALE", "32752"),
        ("DESC.CHAN_1", "LVDT"), ("UNITS.CHAN_1", "mm"), ("SCALE.CHAN_1", f"{12.5 / 32752:.9E}"), ("LOWER_LIMIT.CHAN_1", "-12.5"),
        ("UPPER_LIMIT.CHAN_1", "12.5"), ("DATE", "24-NOV-2026"),
    ]
    head = b"".join(k.encode().ljust(32, b"\0") + v.encode().ljust(96, b"\0") for k, v in keys).ljust(5 * 512, b"\0")
    path = folder / "big.rsp"
    path.write_bytes(head + raw.tobytes())
    bench.same("RPC III, big-endian", columns(path)["LVDT"], raw.astype(float) * float(f"{12.5 / 32752:.9E}"))
    sample = data / "files/test1.rsp"
    if sample.exists():
        content = sample.read_bytes()
        get = {}
        for at in range(0, 18 * 512, 128):
            get[content[at:at + 32].split(b"\0")[0].decode()] = content[at + 32:at + 128].split(b"\0")[0].decode("cp1252")
        first, group = 512 * int(get["NUM_HEADER_BLOCKS"]), int(get["PTS_PER_GROUP"])
        total, channels = int(get["PTS_PER_FRAME"]) * int(get["FRAMES"]), int(get["CHANNELS"])
        got = list(columns(sample).values())
        for c in range(channels):
            values = []
            for g in range(-(-total // group)):
                at = first + 2 * group * (g * channels + c)
                values += struct.unpack(f"<{group}h", content[at:at + 2 * group])
            scale = float(get[f"SCALE.CHAN_{c + 1}"])
            bench.same(f"RPC III test1.rsp, channel {c + 1}", got[c + 1], [v * scale for v in values[:total]])


def every_file(bench, data):
    """Every file of the development data is read without an edit."""
    for path in sorted(p for kind in ("records", "recordings", "files") for p in (data / kind).rglob("*") if p.is_file()):
        if path.suffix.lower() in (".toml", ".md"):
            continue
        def read(path=path):
            got = columns(path)
            print(f"read: {path.relative_to(data)}: {len(got)} columns, {max(map(len, got.values()))} rows")
        bench.guarded(f"{path.relative_to(data)}", read)


def main():
    numpy = library("numpy")
    if not numpy:
        return 0
    data = Path(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("SHAKEDOWN_DATA", ROOT / "../shared/data")).resolve()
    subprocess.run(["cargo", "build", "--quiet", "--package", "shakedown", "--example", "columns"], cwd=ROOT, check=True)
    bench = Bench()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bench.guarded("HDF5", lambda: hdf5(bench, folder, numpy))
        bench.guarded("TDMS", lambda: tdms(bench, folder, numpy, data))
        bench.guarded("MATLAB", lambda: matlab(bench, folder, numpy, data))
        bench.guarded("miniSEED", lambda: miniseed(bench, folder, numpy))
        bench.guarded("text", lambda: text(bench, folder, numpy))
        bench.guarded("RPC III", lambda: rpc(bench, folder, numpy, data))
    if data.exists():
        every_file(bench, data)
    else:
        print(f"SKIPPED: {data} is not at hand; name the folder of the development data")
    print(f"{bench.made} comparisons, {bench.failed} failed")
    return 1 if bench.failed else 0


if __name__ == "__main__":
    sys.exit(main())
