//! A sheet as a SPICE deck, and what ngspice answers.

use std::fmt::Write as _;

use super::sheet::{FilterCorner, Kind, Sheet, Trial};
use crate::shell::{Problem, command, read, target};

/// A wire, and where there is none, ohm.
const WIRE: f64 = 0.1;
const NO_WIRE: f64 = 1e12;
/// Largest offset of an op-amp, V (`items.toml`).
const OFFSET: f64 = 1e-4;

/// Models: an op-amp of 100 dB that ends 0.2 V from its supplies; diodes and switch after their data sheets' typical curves.
const MODELS: &str = "\
.options reltol=1e-6
.model BAT54 D(IS=3e-7 N=1.02 RS=0.5 CJO=10p BV=30)
.model BAV199 D(IS=1e-14 N=1.35 RS=1)
.model D1N4004 D(IS=7e-9 N=1.8 RS=0.04 BV=400)
.model DZ18 D(IS=1e-12 N=1.2 RS=2 BV=18 IBV=1e-3)
.model BSS138 NMOS(LEVEL=1 VTO=1.3 KP=0.2 LAMBDA=0.01)
.model DEND D(IS=1e-12 N=0.2)
.subckt opamp p n out vcc vee params: offset=0
Voffset q p {offset}
Ggain 0 y q n 1e-3
Rgain y 0 1e8
Vabove vcc above 0.2
Vbelow below vee 0.2
Dabove y above DEND
Dbelow below y DEND
Eout z 0 y 0 1
Rout z out 10
.ends
";

/// Where in their tolerances the parts of a run are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner(u64);

impl Corner {
    /// The run of that number; 0 is nominal.
    pub(super) const fn of(run: u64) -> Self {
        Self(run)
    }

    /// -1, 0 or +1 for the part of that number: one end of its tolerance or the other.
    fn end(self, part: usize) -> f64 {
        if self.0 == 0 {
            return 0.0;
        }
        // splitmix64's finaliser.
        let mut z = (self.0 << 32 | part as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        if (z ^ (z >> 31)) & 1 == 0 { -1.0 } else { 1.0 }
    }
}

/// What `trial` of `sheet` comes to, V.
pub(super) fn solved(sheet: &Sheet, trial: &Trial, corner: Corner) -> Result<f64, Problem> {
    let between = trial.between.as_ref().map(|between| &between.nets);
    let wanted = match between {
        Some([a, b]) if b == "0" => format!("v({a})"),
        Some([a, b]) => format!("v({a})-v({b})"),
        None => format!("v({})", sheet.output.net),
    };
    let control = format!("op\nlet answer = {wanted}\nprint answer\n");
    answer(&deck(sheet, Some(trial), None, corner, &control), &format!("{}, {}", sheet.name, trial.name))
}

/// The frequency at which the sheet's filter has lost 3 dB, Hz.
pub(super) fn corner(sheet: &Sheet, corner: Corner) -> Result<f64, Problem> {
    let swept = sheet.corner.as_ref();
    let control = format!(
        "ac dec 200 1 100k\nlet loss = vdb({0}) - vdb({0})[0]\nmeas ac answer when loss=-3.0103\n",
        sheet.output.net
    );
    answer(&deck(sheet, None, swept, corner, &control), &format!("{}, corner", sheet.name))
}

/// The deck with what `control` has the program do.
fn deck(sheet: &Sheet, trial: Option<&Trial>, swept: Option<&FilterCorner>, corner: Corner, control: &str) -> String {
    let mut deck = format!("* {}\n{MODELS}", sheet.title);
    for (number, part) in sheet.parts.iter().enumerate() {
        let value = part.value * (1.0 + part.tolerance * corner.end(number));
        let offset = OFFSET * corner.end(number);
        let energised = trial.is_some_and(|trial| trial.energised.contains(&part.name));
        let (name, nets) = (&part.name, part.pins.join(" "));
        let contact = |closed: bool| if closed { WIRE } else { NO_WIRE };
        let _ = match (part.kind, part.pins.as_slice()) {
            (Kind::Resistor | Kind::Coil, _) => writeln!(deck, "R{name} {nets} {value:e}"),
            (Kind::Capacitor, _) => writeln!(deck, "C{name} {nets} {value:e}"),
            (Kind::Diode, _) => writeln!(deck, "D{name} {nets} {}", part.model),
            (Kind::OpAmp, _) => writeln!(deck, "X{name} {nets} opamp offset={offset:e}"),
            (Kind::Mosfet, [drain, gate, source]) => {
                writeln!(deck, "M{name} {drain} {gate} {source} {source} BSS138")
            }
            (Kind::Changeover, [common, make, rest]) => writeln!(
                deck,
                "R{name}a {common} {make} {:e}\nR{name}b {common} {rest} {:e}",
                contact(energised),
                contact(!energised)
            ),
            (Kind::BreakContact, _) => writeln!(deck, "R{name} {nets} {:e}", contact(!energised)),
            _ => Ok(()),
        };
    }
    deck += &outside(sheet, trial, swept, corner);
    deck + ".control\nset numdgt=9\n" + control + "quit\n.endc\n.end\n"
}

/// Supplies, stimuli, load and short.
fn outside(sheet: &Sheet, trial: Option<&Trial>, swept: Option<&FilterCorner>, corner: Corner) -> String {
    let mut deck = String::new();
    let first = sheet.parts.len();
    for (number, (net, [volts, tolerance])) in sheet.supplies.iter().enumerate() {
        let volts = volts * (1.0 + tolerance * corner.end(first + number));
        let _ = writeln!(deck, "Vsupply{net} {net} 0 {volts:e}");
    }
    let first = first + sheet.supplies.len();
    for (number, (name, stimulus)) in sheet.stimuli.iter().enumerate() {
        let swept = swept.filter(|swept| swept.stimulus == *name);
        let set = trial.and_then(|trial| trial.set.get(name)).copied();
        let volts = set.or(swept.map(|swept| swept.volts)).unwrap_or(0.0);
        let broken = trial.is_some_and(|trial| trial.broken.contains(name));
        let [least, most] = stimulus.ohm;
        let ohm = 0.5 * (least + most + (most - least) * corner.end(first + number));
        let ohm = if broken { NO_WIRE } else { ohm };
        let swept = if swept.is_some() { " ac 1" } else { "" };
        let [plus, minus] = &stimulus.nets;
        let _ =
            writeln!(deck, "V{name} {name}source {minus} dc {volts:e}{swept}\nRof{name} {name}source {plus} {ohm:e}");
    }
    if sheet.output.load > 0.0 {
        let _ = writeln!(deck, "Rload {} 0 {:e}", sheet.output.net, sheet.output.load);
    }
    if let Some([a, b]) = trial.and_then(|trial| trial.short.as_ref()) {
        let _ = writeln!(deck, "Rshort {a} {b} {WIRE:e}");
    }
    deck
}

/// Has ngspice run `deck`; the number that it calls `answer`.
fn answer(deck: &str, what: &str) -> Result<f64, Problem> {
    let folder = target()?.join("front-end");
    let path = folder.join("deck.cir");
    let failed = |e: std::io::Error| Problem::Failed(format!("{}: {e}", path.display()));
    std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, deck)).map_err(failed)?;
    let said = read(&mut command(&["ngspice", "-b", &path.display().to_string()]))?;
    let number = said.lines().find_map(|line| {
        let number = line.trim().strip_prefix("answer")?.trim_start().strip_prefix('=')?;
        number.split_whitespace().next()?.parse::<f64>().ok()
    });
    number.ok_or_else(|| Problem::Failed(format!("{what}: ngspice gave no answer; the deck is {}", path.display())))
}
