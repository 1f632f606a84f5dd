//! Every command's page as a reader sees it, at two widths, light and dark: no overflow, no overlap, no empty figure, and on the
//! first screen the verdict and what it rests on. The pictures stay in `target/pages` to be looked at. Minutes of work:
//! `cargo xtask nightly` runs it.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use serde_json::Value;
use shakedown_tests::binary::shakedown;
use shakedown_tests::browser::{Browser, chromium};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A page's name and the command line that makes it; earlier ones leave files for later ones.
const PAGES: [(&str, &str); 21] = [
    ("run", "run --controller strong"),
    ("modify", "modify near-field-strong --method taut --out drive.csv"),
    ("drive", "run --record drive.csv --controller strong --trace driven.csv"),
    ("qualify", "qualify --synthesise x.csv --standard ac156 --sds 1.0 --z-over-h 0"),
    ("sweep", "sweep slew-rate bode"),
    ("init", "init recordings --force --out first.toml"),
    ("identify", "identify recordings/experiment.toml --out found.toml"),
    ("diagnose", "diagnose recordings/experiment.toml"),
    ("design", "design found.toml"),
    ("learn", "learn --velocity 0.2 --runs 2"),
    ("effects", "effects"),
    ("effect", "effects coulomb_friction"),
    ("faults", "faults --runs 20 --seed 1"),
    ("rubbed", "run --controller current --table friction.toml --scale-to 0.15g --trace friction.csv"),
    ("mismatch", "diagnose mismatch.toml --model better.toml"),
    ("refused", "diagnose still.toml"),
    ("compare", "compare drive.csv driven.csv"),
    ("judged", "qualify x.csv --standard ac156 --sds 1.2 --z-over-h 0"),
    ("bench", "bench"),
    ("prove", "prove --cases 4"),
    ("demo", "demo"),
];

/// A table with dry friction, of which the experiment below knows nothing.
const FRICTION: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n\
    effects = [\"coulomb_friction\"]\n[effects.coulomb_friction]\nforce = 0.5\npresliding = 1e-5\n";
const MISMATCH: &str = "name = \"a table with dry friction\"\n[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\n\
    velocity_limit = 0.242\nfit = [\"b1\", \"b0\", \"a1\"]\n[channels]\ntime = { column = \"time\", unit = \"s\" }\n\
    reference = { column = \"reference\", unit = \"m\" }\ncommand = { column = \"command\", unit = \"1\" }\n\
    displacement = { column = \"displacement\", unit = \"m\", noise = 2e-5 }\n\
    acceleration = { column = \"acceleration\", unit = \"m/s2\", noise = 0.05 }\n[[runs]]\nfile = \"friction.csv\"\n";

/// The files that the command lines name.
fn files(folder: &Path) {
    let made = shakedown().current_dir(folder).args(["sweep", "--write", "recordings"]).output().unwrap();
    assert!(made.status.success());
    let still: String = (0..600).map(|k| format!("{:.3},0,0,0,0\n", 0.005 * f64::from(k))).collect();
    let header = "time [s],reference [m],displacement [m],acceleration [m/s2],command [1]\n";
    for (name, text) in [
        ("friction.toml", FRICTION.to_owned()),
        ("mismatch.toml", MISMATCH.to_owned()),
        ("still.csv", header.to_owned() + &still),
        ("still.toml", MISMATCH.replace("friction.csv", "still.csv")),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
    }
}

/// What is wrong with the page as it stands, in words; an empty list where nothing is.
const LOOK: &str = r"(() => {
    const wrong = [];
    const wide = document.documentElement.scrollWidth - innerWidth;
    if (wide > 0) wrong.push(`the page is ${wide} px wider than the window`);
    const box = (e) => e.getBoundingClientRect();
    const first = [...document.querySelectorAll('body > header, body > .tiles, body > .advice, body > nav, main')].map(
        (e) => [e.tagName + '.' + e.className, box(e)]);
    first.forEach(([a, r], i) => first.slice(i + 1).forEach(([b, s]) => {
        if (r.bottom > s.top + 1 && s.bottom > r.top + 1) wrong.push(`${a} lies over ${b}`);
    }));
    const long = document.documentElement.scrollHeight;
    if (innerWidth > 1000 && !document.querySelector('details[open]') && long > 9000) wrong.push(`the page is ${long} px long, folded`);
    const lead = document.querySelector('.lead');
    if (!lead || !lead.textContent.trim() || box(lead).bottom > 800) wrong.push('no verdict on the first screen');
    for (const tile of document.querySelectorAll('.tiles div, .advice li, h1, h2, figcaption, .legend button'))
        if (tile.scrollWidth > tile.clientWidth + 1 && tile.clientWidth > 0) wrong.push(`cut off: ${tile.textContent.trim().slice(0, 40)}`);
    for (const caption of document.querySelectorAll('.table caption'))
        if (box(caption).width && box(caption).right > innerWidth + 1) wrong.push(`cut off: ${caption.textContent.trim().slice(0, 40)}`);
    for (const table of document.querySelectorAll('.table'))
        if (box(table).right > innerWidth + 1) wrong.push(`a table reaches out: ${table.ariaLabel}`);
    const footer = document.querySelector('footer').innerText;
    for (const said of ['command', 'shakedown ', 'version', 'written'])
        if (!footer.includes(said)) wrong.push(`the footer does not state ${said}`);
    if (/\[1\]/.test(document.body.innerText)) wrong.push('[1] stands as a unit');
    return wrong;
})()";

/// The figures that show nothing, by their captions; those that say so are not among them.
const EMPTY: &str = r"(() => [...document.querySelectorAll('figure')].filter((figure) => {
    const canvas = figure.querySelector('canvas');
    if (!canvas) return !figure.querySelector('.empty');
    const { width, height } = canvas;
    if (!width || !height) return true;
    const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, width, height).data.buffer);
    return new Set(pixels).size < 6;
}).map((figure) => figure.querySelector('figcaption').textContent))()";

fn words(value: &Value) -> Vec<String> {
    value.as_array().into_iter().flatten().filter_map(|w| w.as_str().map(str::to_owned)).collect()
}

/// Where the pictures go.
fn album() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../pages");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Makes a page and looks at it every way.
fn looked_at(browser: &mut Browser, folder: &Path, name: &str, line: &str) -> Vec<String> {
    let page = folder.join(format!("{name}.html"));
    let arguments: Vec<&str> = line.split(' ').chain(["--report", page.to_str().unwrap()]).collect();
    let output = shakedown().current_dir(folder).args(arguments).output().unwrap();
    // A gate that is missed ends with status 1, and its page is shown as well.
    assert!(page.exists(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    let mut wrong = Vec::new();
    for (width, height) in [(1280, 900), (400, 860)] {
        for scheme in ["light", "dark"] {
            let mut say = |what: String| wrong.push(format!("{name}, {width} px, {scheme}: {what}"));
            browser.scheme(scheme).unwrap();
            browser.resize(width, height).unwrap();
            browser.open(&page).unwrap();
            browser.value("scrollTo(0, 0)").unwrap();
            words(&browser.value(LOOK).unwrap()).into_iter().for_each(&mut say);
            browser.value("document.querySelectorAll('details').forEach((d) => { d.open = true; })").unwrap();
            browser.settle().unwrap();
            browser.settle().unwrap();
            for figure in words(&browser.value(EMPTY).unwrap()) {
                say(format!("empty figure: {figure}"));
            }
            for what in words(&browser.value(LOOK).unwrap()).iter().filter(|what| what.contains("wider")) {
                say(format!("unfolded, {what}"));
            }
            browser.picture(&album().join(format!("{name}-{width}-{scheme}.png"))).unwrap();
        }
    }
    wrong
}

#[test]
#[ignore = "minutes of commands and pictures: cargo xtask nightly"]
fn every_page_shows_what_it_says_at_every_width() {
    let Some(program) = chromium() else { return };
    let folder = TempDir::new().unwrap();
    files(folder.path());
    let mut browser = Browser::start(program, 1280, 900).expect("Chromium starts");
    let wrong: Vec<String> =
        PAGES.iter().flat_map(|(name, line)| looked_at(&mut browser, folder.path(), name, line)).collect();
    assert_eq!(browser.complaints(), [""; 0], "console");
    let asked = browser.requests();
    assert!(asked.iter().all(|address| address.starts_with("file://") || address == "about:blank"), "{asked:?}");
    assert!(wrong.is_empty(), "{} faults; pictures in {}:\n{}", wrong.len(), album().display(), wrong.join("\n"));
}

/// The looking itself: a page that is broken in each way is found out.
#[test]
fn a_page_that_overflows_or_is_empty_is_found_out() {
    let Some(program) = chromium() else { return };
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("page.html");
    shakedown_tests::sample::page().write(&page).unwrap();
    let html = std::fs::read_to_string(&page).unwrap();
    let mut browser = Browser::start(program, 1280, 900).expect("Chromium starts");
    let mut seen = |html: &str| {
        std::fs::write(&page, html).unwrap();
        browser.open(&page).unwrap();
        [words(&browser.value(LOOK).unwrap()), words(&browser.value(EMPTY).unwrap())].concat().join("; ")
    };
    let whole = seen(&html);
    assert!(!whole.contains("wider") && !whole.contains("verdict") && !whole.contains("lies over"), "{whole}");
    assert!(whole.contains("does not state command"), "{whole}");
    assert!(seen(&html.replace("<main>", "<main><div style=\"width:3000px\">wide</div>")).contains("px wider"));
    assert!(seen(&html.replace("class=\"lead\"", "class=\"led\"")).contains("no verdict"));
    assert!(
        seen(
            &html.replace("</header>", "</header><div class=\"tiles\" style=\"margin-top:-150px\"><div>x</div></div>")
        )
        .contains("lies over")
    );
    let blank = "setTimeout(() => document.querySelectorAll('canvas').forEach((c) => { c.width = c.width; }), 0)";
    let emptied = html.replace("</body>", &format!("<script>{blank}</script></body>"));
    assert_ne!(seen(&emptied), whole, "blank canvases");
}
