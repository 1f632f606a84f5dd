"""Files that other software wrote, read by shakedown and by that software, value by value.

    python3 tests/readers/check.py [DATA [MORE]]

Needs numpy, scipy, h5py, npTDMS, obspy, pandas, rpc3-file, rpc_reader and lvm_read; what is missing is said and left out. MORE is a folder of
LabVIEW's own .lvm files, where one is at hand. Then ten of the files get false metadata, and each must be refused by its name and by
what is wrong. Ends with status 1 where a value differs by more than rounding or a false file is read. `cargo build -p shakedown
--example columns` comes first, and this calls it.
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
TOOL = COLUMNS.parents[1] / "shakedown"
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

    def refused(self, what, path, said):
        """A file that the tool must not read: status 2, and a message that names the file and what is wrong with it."""
        self.made += 1
        done = subprocess.run([TOOL, "run", "--record", path, "--channel", "1", "--unit", "g"], capture_output=True, text=True)
        ok = done.returncode == 2 and path.name in done.stderr and all(part in done.stderr for part in said)
        self.failed += not ok
        print(f"{'refused' if ok else 'NOT REFUSED'}: {what}: {(done.stderr or done.stdout).strip()[:200]}")

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


def matlab73(bench, numpy, data):
    """Arrays of a MATLAB 7.3 file, by the library that the format is made of."""
    h5py = library("h5py")
    path = data / "files/v73.mat"
    if not h5py or not path.exists():
        return
    got = columns(path)
    with h5py.File(path) as f:
        for name in ["secondvar", "data/arr_double", "data/arr_nan", "data/struct_/test"]:
            own = name.replace("/", ".")
            bench.same(f"MATLAB 7.3 {name}", got.get(own, []), f[name][()].ravel())
        for k in range(f["data/arr_two_three"].shape[0]):
            bench.same(f"MATLAB 7.3 arr_two_three, column {k + 1}", got[f"data.arr_two_three(:;{k + 1})"], f["data/arr_two_three"][k])


def spreadsheet(bench, folder, numpy):
    """UTF-16, decimal commas and semicolons as pandas writes them."""
    pandas = library("pandas")
    if not pandas:
        return
    t, x, a = wave(numpy, 400)
    frame = pandas.DataFrame({"time [s]": t, "Weg [mm]": x, "acc [g]": a})
    for name, encoding, separator, decimal in [("wide", "utf-16", "\t", "."), ("german", "utf-16", ";", ","), ("plain", "cp1252", ";", ",")]:
        path = folder / f"{name}.csv"
        frame.to_csv(path, sep=separator, decimal=decimal, encoding=encoding, index=False)
        got = columns(path)
        want = pandas.read_csv(path, sep=separator, decimal=decimal, encoding=encoding)
        for column in frame:
            bench.same(f"text that pandas wrote, {name}, {column}", got[column], want[column])


def labview(bench, folder, more):
    """LabVIEW's text by another reader: one made here, and whatever files of its own are at hand."""
    lvm = library("lvm_read")
    if not lvm:
        return
    for path in [folder / "made.lvm", *(sorted(more.glob("*.lvm")) if more else [])]:
        want = lvm.read(str(path), read_from_pickle=False, dump_file=False)[0]
        got = columns(path)
        several = want["Channel names"].count("X_Value") > 1
        for i, name in enumerate(want["Channel names"][: want["data"].shape[1]]):
            if name == "X_Value":
                name = f"X_Value of {want['Channel names'][i + 1]}" if several else name
                if all(math.isnan(v) for v in want["data"][:, i]):
                    continue
            # A channel that was never sampled is no column of numbers.
            if not all(math.isnan(v) for v in want["data"][:, i]):
                bench.same(f"LabVIEW {path.name} {name}", got.get(name, []), want["data"][:, i])


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


def rpc_of_others(bench, folder, numpy):
    """RPC III that rpc3-file wrote; the same with its bytes in the other order, which no library at hand writes."""
    rpc3 = library("rpc3")
    if not rpc3:
        return
    _, x, a = wave(numpy, 2048)
    made = [rpc3.Channel("LVDT", "mm", 0.005, x), rpc3.Channel("acc", "g", 0.005, a)]
    for kind, word in [(int, "h"), (float, "f")]:
        path = folder / f"theirs-{word}.rsp"
        rpc3.write(str(path), made, datatype=kind, overwrite=True)
        want = {c.name: c.data for c in rpc3.read(str(path))[0]}
        content = path.read_bytes()
        keys = {content[k:k + 32].rstrip(b"\0"): content[k + 32:k + 128].rstrip(b"\0") for k in range(0, 512, 128)}
        start = 512 * int(keys[b"NUM_HEADER_BLOCKS"])
        # The first key, whose value is BINARY or BINARY_IEEE_LITTLE_END by that library's version.
        head = content[:32] + b"BINARY_IEEE_BIG_END".ljust(96, b"\0") + content[128:start]
        turned = folder / f"turned-{word}.rsp"
        turned.write_bytes(head + numpy.frombuffer(content[start:], "<i2" if word == "h" else "<f4").byteswap().tobytes())
        for file in (path, turned):
            got = columns(file)
            for name in want:
                # Single precision is what that library keeps a raw number times its scale in.
                bench.same(f"RPC III {file.name} {name}", got[name][: len(want[name])], want[name], 1e-6)


def drives(bench, folder):
    """A drive in RPC III by shakedown, read by two other libraries, beside the same in text."""
    def made(name, *more):
        path = folder / name
        subprocess.run([TOOL, "modify", "near-field-moderate", "--method", "taut", "--out", path, *more], check=True, capture_output=True)
        return path
    rows = [line.split(",") for line in made("drive.csv").read_text().splitlines() if line[0].isdigit()]
    want = [float(value) for _, value in rows]
    for path, bound in [(made("single.rpc"), 1e-6), (made("short.rpc", "--sixteen-bit"), 1.6e-5)]:
        rpc3, reader = library("rpc3"), library("rpc_reader.rpc_reader")
        if rpc3:
            # It leaves out an end that does not change, which it takes for what fills the last frame.
            found = [*rpc3.read(str(path))[0][0].data, *[0.0] * len(want)]
            bench.same(f"{path.name} by rpc3-file", found[: len(want)], want, bound)
        # It takes INT_FULL_SCALE for a factor of short integers, which MTS does not: 0.049 % low.
        if reader and bound == 1e-6:
            theirs = reader.ReadRPC(str(path))
            theirs.import_rpc_data_from_file()
            bench.same(f"{path.name} by rpc-reader", theirs.data[: len(want), 0], want, bound)


def put(path, content, at, bytes_):
    """The same file with some bytes replaced."""
    path.write_bytes(content[:at] + bytes_ + content[at + len(bytes_):])
    return path


def false_metadata(bench, folder, data):
    """Ten files whose header says what is not so."""
    def falsified(name, source, old, new):
        content = source.read_bytes()
        if old not in content:
            raise ValueError(f"{source.name} holds no {old}")
        return put(folder / name, content, content.index(old), new)

    def keyed(name, source, key, value):
        content = source.read_bytes()
        return put(folder / name, content, content.index(key.encode().ljust(32, b"\0")) + 32, value.encode().ljust(96, b"\0"))

    big, records = folder / "big.rsp", data / "records"
    cases = [
        ("RPC III, frames that are not there", keyed("frames.rsp", big, "FRAMES", "40"), ["cut off"]),
        ("RPC III, an interval of nothing", keyed("step.rsp", big, "DELTA_T", "0.0"), ["DELTA_T"]),
        ("RPC III, a million blocks of header", keyed("blocks.rsp", big, "NUM_HEADER_BLOCKS", "999999"), ["NUM_HEADER_BLOCKS"]),
        ("TDMS, raw data beyond the end", falsified("beyond.tdms", folder / "made.tdms", *beyond(folder / "made.tdms")), ["beyond its end"]),
        ("TDMS, a version that there is not", put(folder / "version.tdms", (folder / "made.tdms").read_bytes(), 8, b"\x01\0\0\0"), ["version"]),
        ("HDF5, cut in half", cut(folder / "half.h5", folder / "chunked.h5"), ["HDF5"]),
        ("miniSEED, more samples than its frames hold", put(folder / "count.mseed", (folder / "STEIM2b.mseed").read_bytes(), 30, b"\xff\xff"), ["sample count"]),
        ("MATLAB, more values than its bytes hold", matlab_count(folder), ["300000 values"]),
        ("text, seconds called milliseconds", unit_of_time(folder), ["ms"]),
    ]
    for name, old, new in [
        ("RSN1106_KOBE_KJM000.AT2", b"NPTS =   7500", b"NPTS =   7501"),
        ("AOM0011801241951.NS", b"Max. Acc. (gal)   4", b"Max. Acc. (gal)   9"),
    ]:
        if (records / name).exists():
            cases.append((f"{name}, {old.decode().strip()}", falsified(name, records / name, old, new), [" but "]))
    for what, path, said in cases:
        bench.refused(what, path, said)


def beyond(path):
    """The raw offset of a first segment, and one that lies beyond the file."""
    content = path.read_bytes()
    return content[12:28], content[12:20] + struct.pack("<Q", 10**9)


def cut(path, source):
    path.write_bytes(source.read_bytes()[: source.stat().st_size // 2])
    return path


def matlab_count(folder):
    """A column of 3000 values that says it has 300,000."""
    import numpy
    import scipy.io
    source = folder / "plain.mat"
    scipy.io.savemat(source, {"x": numpy.arange(3000.0)}, oned_as="column")
    content = source.read_bytes()
    return put(folder / "count.mat", content, content.index(struct.pack("<ii", 3000, 1)), struct.pack("<ii", 300_000, 1))


def unit_of_time(folder):
    path = folder / "ms.csv"
    path.write_text("time [ms],acc [g]\n" + "".join(f"{k * 0.005:.3f},{k % 5}\n" for k in range(400)))
    return path


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
    more = Path(sys.argv[2]) if len(sys.argv) > 2 else None
    data = Path(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("SHAKEDOWN_DATA", ROOT / "../shared/data")).resolve()
    subprocess.run(["cargo", "build", "--quiet", "--package", "shakedown", "--bin", "shakedown", "--example", "columns"], cwd=ROOT, check=True)
    bench = Bench()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bench.guarded("HDF5", lambda: hdf5(bench, folder, numpy))
        bench.guarded("TDMS", lambda: tdms(bench, folder, numpy, data))
        bench.guarded("MATLAB", lambda: matlab(bench, folder, numpy, data))
        bench.guarded("miniSEED", lambda: miniseed(bench, folder, numpy))
        bench.guarded("text", lambda: text(bench, folder, numpy))
        bench.guarded("RPC III", lambda: rpc(bench, folder, numpy, data))
        bench.guarded("RPC III of others", lambda: rpc_of_others(bench, folder, numpy))
        bench.guarded("drives", lambda: drives(bench, folder))
        bench.guarded("MATLAB 7.3", lambda: matlab73(bench, numpy, data))
        bench.guarded("spreadsheet", lambda: spreadsheet(bench, folder, numpy))
        bench.guarded("LabVIEW", lambda: labview(bench, folder, more))
        bench.guarded("false metadata", lambda: false_metadata(bench, folder, data))
    if data.exists():
        every_file(bench, data)
    else:
        print(f"SKIPPED: {data} is not at hand; name the folder of the development data")
    print(f"{bench.made} comparisons, {bench.failed} failed")
    return 1 if bench.failed else 0


if __name__ == "__main__":
    sys.exit(main())
