//! The figures. A new one is one entry; its command is one that a reader can paste.

use super::Figure;

const fn figure(of: &'static str, name: &'static str, bound: &'static str, command: &'static str) -> Figure {
    Figure { of, name, bound, command }
}

const GROUND: &str = "plant, paper, closed loop";
const FIT: &str = "record fitting";
const DEVICE: &str = "firmware";
const IDENTIFY: &str = "identification";
const DIAGNOSE: &str = "diagnosis and its proof";
const CONTROL: &str = "control";
const SAFETY: &str = "safety and robustness";
const BUILD: &str = "build and report";
const HOSTS: &str = "hosts of the core and the library";
const LABORATORY: &str = "laboratory";
const SHOWN: &str = "pages, live, input";

const TABLE1: &str = "cargo run --release -- table1 --records ../shared/data/records";
const BENCH: &str = "cargo bench -p shakedown --bench closed_loop";
const PROVE: &str = "cargo run --release -- prove --seed N --cases K";
const RESOLUTION: &str =
    "cargo test --ignore-rust-version -p shakedown-replay --test emulated resolution:: -- --nocapture";
const BITS: &str = "cargo test --ignore-rust-version -p shakedown-replay --test emulated bit_identity::";
const FITTING: &str = "cargo test --release -p shakedown --test fitting -- --nocapture --test-threads 1";
const HELD: &str = "cargo run --release -- bench --records ../shared/data/records --limits-only";
const FITTED: &str = "cargo test --release -p shakedown --test identify -- --nocapture --test-threads 1";
const FIT_BENCH: &str = "cargo bench -p shakedown --bench identify";
const LAW_COST: &str = "cargo xtask law-cost";
const FAULTS: &str =
    "cargo run --release -- faults --seed 311131 --runs 100000 --records ../shared/data/records --out faults";
const ALONE: &str =
    "cargo run --release -- faults --seed 311133 --runs 100000 --guard-alone --records ../shared/data/records";
const HEALTHY: &str = "cargo run --release -- faults --healthy 10000 --seed 311136 --records ../shared/data/records";
const REHEARSAL: &str =
    "cargo test --ignore-rust-version -p shakedown-replay --test emulated rehearsal:: -- --nocapture";
const WEB: &str = "cargo xtask page && cargo test --release -p shakedown-tests --test web -- --include-ignored --nocapture --test-threads 1";
const LEARNING: &str = "cargo run --release -p shakedown --example learning";
const REQUIRED: &str = "cargo run --release -p shakedown --example required_spectra";
const INNER_LOOP: &str = "CASES=50 cargo test --release -p shakedown --test inner_loop -- --nocapture";
const LIVE: &str =
    "cargo test --release -p shakedown-tests --test live -- --include-ignored --nocapture --test-threads 1";
const NONE: &str = "";

pub(super) const FIGURES: &[Figure] = &[
    figure(GROUND, "Taft Current and Strong against the paper, E_d and peak", "within 20 %", TABLE1),
    figure(GROUND, "El Centro Current against the paper, E_d and peak", "within 15 %", TABLE1),
    figure(GROUND, "Kobe Strong against the paper, peak", "within 5 %", TABLE1),
    figure(GROUND, "both Current rows, E_a in the squared reading", "within 35 %", TABLE1),
    figure(
        GROUND,
        "sampled linear loop against its z-domain closed form, f64 and f32 core",
        "1e-6 of the amplitude",
        "cargo test -p shakedown-tests --test analytic",
    ),
    figure(GROUND, "slope of the limiter's saw-tooth", "0.242 m/s exactly", "cargo run --release -- sweep saw-tooth"),
    figure(GROUND, "60 s at 1 kHz, 10 plant steps a tick, one core", "5,000 times real time or more", BENCH),
    figure(GROUND, "the same arithmetic against plain C with -O3", "ratio at most 1.2", BENCH),
    figure(FIT, "taut string against the convex optimum, velocity alone binding", "within 0.1 %", FITTING),
    figure(FIT, "convex fit against SciPy's NNLS", "within 1 %", FITTING),
    figure(
        FIT,
        "60 s at 1 kHz: taut string; convex",
        "under 5 ms; under 5 s",
        "cargo bench -p shakedown --bench fitting",
    ),
    figure(FIT, "Kobe at 0.74 g: offline E_a", "within 1 % of 0.397 (clip 0.639)", FITTING),
    figure(FIT, "Kobe at 0.74 g: E_a with 0.5 s of preview", "at most 0.42", FITTING),
    figure(FIT, "causal: displacement at the end against the reference's", "within 1 mm on every record", FITTING),
    figure(FIT, "causal: E_a over clip's, Kobe and El Centro; elsewhere", "at most 0.95; 1", FITTING),
    figure(FIT, "Kobe: S_a (5 %) kept over 0.05 to 0.5 s at 0.242 m/s", "within 5 %", FITTING),
    figure(
        FIT,
        "any input: over the limits; stopping inside the stroke",
        "one f32 ulp; always",
        "cargo test -p shakedown-core --test record",
    ),
    figure(FIT, "preview of 0.5 s at 1 kHz on a Cortex-M4, instructions of any tick", "at most 1,500", LAW_COST),
    figure(FIT, "strong PI on fitted records: peak over the reference's", "at most 1.05", FITTING),
    figure(FIT, "the same on Table 1's records, beside its rows", "at most 1.05", TABLE1),
    figure(DEVICE, "command codes, emulated image against host, 60 s near field, each mode", "all the same", BITS),
    figure(DEVICE, "the same from another emulator", "all the same", "cargo xtask replay second_opinion"),
    figure(DEVICE, "rehearsal: telemetry, image against host, 60 s in every mode", "the same bits", REHEARSAL),
    figure(DEVICE, "rehearsal: dearest tick at 6 cycles an instruction, share of 1 ms", "at most 40 %", REHEARSAL),
    figure(DEVICE, "front end: levels in ten runs over the tolerances", "within 0.5 %", "cargo xtask front-end"),
    figure(
        DEVICE,
        "front end: a wire that breaks, either of an input's; a short of a sensor, in the same runs",
        "beyond a rail",
        "cargo xtask front-end",
    ),
    figure(DEVICE, "displacement at rest, standard deviation: on the chip, outboard", "at most 25; 5 um", RESOLUTION),
    figure(
        DEVICE,
        "retired instructions of the core's step, median, in every mode",
        "at most 1,200",
        "cargo xtask beside",
    ),
    figure(
        DEVICE,
        "retired instructions a tick, board included, every mode: median; dearest with the relay closed; flash; RAM",
        "at most 1,200; 6,000; 103,400; 29,200 byte",
        "cargo xtask replay cost",
    ),
    figure(DEVICE, "the core's laws beside the same in C, in instructions", "ratio at most 1.1", "cargo xtask beside"),
    figure(
        DEVICE,
        "replay speed on one core, once the image is translated",
        "50,000 ticks/s or more",
        "cargo run --profile replay --ignore-rust-version -p shakedown-replay --example speed",
    ),
    figure(IDENTIFY, "Eq. 7 and 0.242 m/s from simulated sweeps", "within 2 % (b1 5 %)", FITTED),
    figure(
        IDENTIFY,
        "coverage of 90 % intervals, 200 seeds, white and coloured noise",
        "85 to 95 %",
        "cargo run --release -p shakedown --example coverage",
    ),
    figure(IDENTIFY, "EMPS, all of the data: M, Fv, Fc, offset", "within 1, 2, 1.5, 3 % of the published", FITTED),
    figure(IDENTIFY, "EMPS, held-out controller-voltage error; pulses declared", "at most 6 %; 9 %", FITTED),
    figure(IDENTIFY, "EMPS official task, RMSE (8.0 mm: missed)", "at most 4.61 mm", "cargo xtask benchmarks"),
    figure(
        IDENTIFY,
        "effects of a user's own, five textbook equations: fitted; found",
        "within 5 %; each",
        "cargo test --release -p shakedown --test own_effects -- --nocapture",
    ),
    figure(
        IDENTIFY,
        "compare: 5 % gain, 20 % friction, 2 % frequency found; same table, 300 pairs",
        "each; 1 % report a change",
        "PAIRS=300 cargo test --release -p shakedown --test compare -- --nocapture",
    ),
    figure(IDENTIFY, "real shake table, held-out R2: CHY027 and KAU039; TAP089", "0.993; 0.96 or more", FITTED),
    figure(IDENTIFY, "wrong data named; alarms on clean recordings", "every case; none", FITTED),
    figure(IDENTIFY, "servo model, 4 runs of 60 s at 1 kHz, 6 parameters, 2 cores", "under 2 s", FIT_BENCH),
    figure(IDENTIFY, "the same beside SciPy over a simulation compiled by numba", "at least 5 times faster", FIT_BENCH),
    figure(DIAGNOSE, "nulls falsely named; unlisted wrongly named", "at most 1 %; 5 %", PROVE),
    figure(DIAGNOSE, "right set where gross; clear; pairs", "at least 95; 85; 85 %", PROVE),
    figure(DIAGNOSE, "coverage of 90 % intervals of named effects", "85 to 95 %", PROVE),
    figure(DIAGNOSE, "real shake table, held-out R2 of the pressure, each run", "at least 0.90", NONE),
    figure(DIAGNOSE, "4 runs of 30 s at 1 kHz, whole library with pairs, 2 cores", "under 20 s", NONE),
    figure(CONTROL, "El Centro on the paper's plant, E_a unsquared", "at most 0.05", HELD),
    figure(
        CONTROL,
        "Kobe fitted: E_a over the fitted record's own; peak over the reference's",
        "at most 1.03; 1.05",
        HELD,
    ),
    figure(CONTROL, "oil-resonance plant: bandwidth with 6 dB and 30 degrees", "at least 25 Hz", HELD),
    figure(
        CONTROL,
        "gain and pole of the paper's plant 30 % off, E_a against the commanded record",
        "at most 0.05",
        HELD,
    ),
    figure(CONTROL, "oil with droop: gain, pole, mass, supply 30 % off, E_a commanded", "at most 0.15", HELD),
    figure(
        CONTROL,
        "El Centro with sensors on, below 15 Hz, designed for a model known to 5 %",
        "at most three-variable control's in the same run",
        HELD,
    ),
    figure(CONTROL, "tracking law, instructions a tick on a Cortex-M4", "at most 1,200", LAW_COST),
    figure(CONTROL, "tracking law, bits of every command on target and host", "all the same", "cargo xtask law-cost"),
    figure(SAFETY, "100,000 faulted runs: excursions beyond stroke less margin; unreported", "none; none", FAULTS),
    figure(SAFETY, "the same: latencies by class of fault", "as docs/hazards.md says", FAULTS),
    figure(SAFETY, "100,000 faulted runs, the guard alone: promises broken", "none", ALONE),
    figure(SAFETY, "10,000 healthy tests: trips, with their 95 % bound", "none, at most 0.03 %", HEALTHY),
    figure(
        SAFETY,
        "times that 10^9 bytes of each kind of noise arm a device",
        "none",
        "cargo run --release -p shakedown-firmware --example noise",
    ),
    figure(
        SAFETY,
        "memory over 24 h in the loop, from the first hour to the last",
        "grows by 512 KiB at most",
        "cargo run --release -p shakedown --example soak",
    ),
    figure(
        SAFETY,
        "mutants of the core that survive",
        "under 5 %, each in docs/mutants.md",
        "cargo mutants -p shakedown-core -j 2 --shuffle -- --tests",
    ),
    figure(SAFETY, "properties on cases drawn anew", "all hold", "cargo xtask properties 100"),
    figure(SAFETY, "an hour of fuzzing a target", "no finding", "cargo xtask fuzz TARGET 3600"),
    figure(
        BUILD,
        "first build of the host tool on 2 cores",
        "under 4 minutes",
        "time CARGO_TARGET_DIR=$(mktemp -d) cargo build --release --locked",
    ),
    figure(
        BUILD,
        "two builds of host tool and every board's image, from two folders",
        "the same bytes",
        "cargo xtask reproduce",
    ),
    figure(
        BUILD,
        "requests and console messages of a report in Chromium",
        "none",
        "cargo test -p shakedown-tests --test report_page",
    ),
    figure(
        HOSTS,
        "one tape in Rust, thumbv7em, C, Python, wasm and FMU: digests",
        "nine equal; a flipped bit found",
        "cargo xtask hosts",
    ),
    figure(
        HOSTS,
        "Python: diagnosis of the given recordings against the command line's",
        "equal",
        "cargo xtask hosts python",
    ),
    figure(HOSTS, "wheel; page", "at most 15 MB; 6 MB", "cargo xtask hosts python && cargo xtask page"),
    figure(
        HOSTS,
        "the twin's FMU, alone and in a loop with the core's, against `shakedown run`",
        "the same bits",
        "cargo xtask hosts fmu",
    ),
    figure(
        HOSTS,
        "Python: a call of step over C; a run over Rust",
        "at most 1 us; 1.1",
        "cargo xtask hosts python && cargo xtask hosts cost",
    ),
    figure(HOSTS, "browser: Kobe by taut string, page and all; by convex; a single effect named", "0.5, 8, 60 s", WEB),
    figure(HOSTS, "browser: results against the command line's; requests", "1e-9 relative; none", WEB),
    figure(
        LABORATORY,
        "files of other software, against npTDMS, h5py, SciPy, ObsPy, pandas, rpc3-file, lvm_read; false metadata",
        "within 1e-12; ten refused",
        "cargo build -p shakedown --bin shakedown --example columns && python3 tests/readers/check.py",
    ),
    figure(
        LABORATORY,
        "a drive written, read back, played by the emulated device",
        "within 1e-6 of its peak",
        "cargo test -p shakedown-tests --test commands drives:: && cargo test --ignore-rust-version -p shakedown-replay --test paced drive",
    ),
    figure(LABORATORY, "learning: limits; error after one run over plain learning's", "kept; at most 0.5", LEARNING),
    figure(LABORATORY, "softened payload found; false alarms, far bounds", "at least 95; at most 2 %", LEARNING),
    figure(LABORATORY, "response spectra against closed forms", "within 0.1 %", REQUIRED),
    figure(LABORATORY, "20 required spectra by 5 tables: neither met nor proven out of reach", "at most 5", REQUIRED),
    figure(LABORATORY, "concealed inner loops: gains at the median; in 90 %", "within 3; 10 %", INNER_LOOP),
    figure(
        LABORATORY,
        "synthetic motion of known margin: verdict, margin, the violated rule",
        "right; named",
        "cargo test --release -p shakedown --lib motion::qualify",
    ),
    figure(
        SHOWN,
        "every page at 1280 and 400 px, light and dark: overflow, overlap, empty figures",
        "none",
        "cargo test --release -p shakedown-tests --test pages -- --include-ignored",
    ),
    figure(
        SHOWN,
        "wrong inputs over all commands: status 2, file, place, remedy",
        "each of 150 or more",
        "cargo test -p shakedown-tests --test commands wrong_input::",
    ),
    figure(SHOWN, "an hour of fuzzing the command line", "no panic", "cargo xtask fuzz command-line 3600"),
    figure(SHOWN, "ten minutes of 1 kHz telemetry: drops; redraws; memory", "all counted; 10 a second; flat", LIVE),
    figure(
        SHOWN,
        "tutorial's commands; its first chapters with the binary alone",
        "each does what it shows",
        "cargo test -p shakedown-tests --test commands tutorial:: && cargo xtask release host",
    ),
];
