//! A sheet as a drawing. Parts are where the sheet puts them; wires join the pins of a net by right angles, the nearest first.
//! Ground and supplies are named at each pin instead.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::list::engineering;
use super::sheet::{Kind, Part, Sheet};

/// Pixels of a grid unit, and of the margin.
const UNIT: f64 = 40.0;
const MARGIN: f64 = 60.0;
/// Longest wire that is drawn, grid units; farther pins of a net are joined by its name.
const FAR: f64 = 7.0;

type Point = (f64, f64);

/// The drawing.
pub(super) fn svg(sheet: &Sheet) -> String {
    let pins: Vec<(&str, Point)> = sheet.parts.iter().flat_map(placed).collect();
    let ends = |of: fn(&Point) -> f64| pins.iter().map(|(_, pin)| of(pin)).fold(0.0, f64::max);
    let (width, height) = ((ends(|p| p.0) + 2.0) * UNIT + 2.0 * MARGIN, (ends(|p| p.1) + 1.0) * UNIT + 2.0 * MARGIN);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" \
         font-size=\"12\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.5\">\n\
         <rect width=\"{width:.0}\" height=\"{height:.0}\" fill=\"#fff\" stroke=\"none\"/>\n"
    );
    text(&mut svg, (MARGIN / 2.0, 24.0), &sheet.title, 15);
    for (net, pins) in by_net(&pins) {
        if net == "0" {
            for &pin in &pins {
                ground(&mut svg, pin, downward(sheet, pin));
            }
        } else if sheet.supplies.contains_key(net) {
            for &pin in &pins {
                label(&mut svg, pin, net);
            }
        } else {
            wires(&mut svg, sheet, net, &pins);
        }
    }
    sheet.parts.iter().for_each(|part| symbol(&mut svg, part));
    svg + "</svg>\n"
}

fn by_net<'p>(pins: &[(&'p str, Point)]) -> BTreeMap<&'p str, Vec<Point>> {
    let mut nets: BTreeMap<&str, Vec<Point>> = BTreeMap::new();
    for &(net, pin) in pins {
        nets.entry(net).or_default().push(pin);
    }
    nets
}

/// Where the pins of `kind` are, grid units from its place, before it is turned.
fn pins(kind: Kind, count: usize) -> Vec<Point> {
    match kind {
        Kind::Resistor | Kind::Capacitor | Kind::Diode | Kind::Coil | Kind::BreakContact => {
            vec![(0.0, 0.0), (1.0, 0.0)]
        }
        Kind::OpAmp => vec![(-0.5, -0.5), (-0.5, 0.5), (2.5, 0.0), (1.0, -0.75), (1.0, 0.75)],
        Kind::Mosfet => vec![(1.0, -1.0), (0.0, 0.0), (1.0, 1.0)],
        Kind::Changeover => vec![(2.0, 0.0), (0.0, -1.0), (0.0, 1.0)],
        Kind::Terminal => (0..count).map(|pin| (0.0, pin as f64)).collect(),
    }
}

/// The nets of a part's pins, and where those are.
fn placed(part: &Part) -> impl Iterator<Item = (&str, Point)> {
    let places = pins(part.kind, part.pins.len());
    part.pins.iter().zip(places).map(|(net, place)| (net.as_str(), at(part, place)))
}

/// A point of a part on the sheet, grid units.
fn at(part: &Part, (x, y): Point) -> Point {
    let (x, y) = match part.turn % 4 {
        1 => (-y, x),
        2 => (-x, -y),
        3 => (y, -x),
        _ => (x, y),
    };
    (f64::from(part.at[0]) + x, f64::from(part.at[1]) + y)
}

/// The same in pixels.
fn pixel((x, y): Point) -> Point {
    (MARGIN + x * UNIT, MARGIN + (y + 0.5) * UNIT)
}

fn line(svg: &mut String, points: &[Point]) {
    let points: Vec<String> = points.iter().map(|&p| pixel(p)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ = writeln!(svg, "<polyline points=\"{}\"/>", points.join(" "));
}

fn text(svg: &mut String, (x, y): Point, words: &str, size: u32) {
    let words = words.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"#222\" stroke=\"none\">{words}</text>"
    );
}

fn dot(svg: &mut String, point: Point) {
    let (x, y) = pixel(point);
    let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#222\"/>");
}

/// Which way from `pin` there is room for a symbol: down, or up from a part that lies below its pin.
fn downward(sheet: &Sheet, pin: Point) -> f64 {
    let below =
        |part: &&Part| part.turn % 4 == 3 && placed(part).any(|(_, at)| at == pin) && pin.1 < f64::from(part.at[1]);
    if sheet.parts.iter().any(|part| below(&part)) { -1.0 } else { 1.0 }
}

fn ground(svg: &mut String, pin: Point, down: f64) {
    let (x, y) = pin;
    line(svg, &[pin, (x, y + 0.25 * down)]);
    line(svg, &[(x - 0.2, y + 0.25 * down), (x + 0.2, y + 0.25 * down)]);
    line(svg, &[(x - 0.1, y + 0.33 * down), (x + 0.1, y + 0.33 * down)]);
}

fn label(svg: &mut String, pin: Point, net: &str) {
    let (x, y) = pixel(pin);
    let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>");
    let _ = writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"#06c\" stroke=\"none\">{net}</text>", x + 4.0, y - 5.0);
}

/// From `from` to `to` by one right angle, on the side where no part lies along it.
fn way(sheet: &Sheet, from: Point, to: Point) -> [Point; 3] {
    let ways = [[from, (to.0, from.1), to], [from, (from.0, to.1), to]];
    let clear =
        |way: &[Point; 3]| !way.windows(2).any(|leg| sheet.parts.iter().any(|part| along(part, leg[0], leg[1])));
    if clear(&ways[0]) || !clear(&ways[1]) { ways[0] } else { ways[1] }
}

/// Whether the straight line between two points runs along a part of two pins.
fn along(part: &Part, a: Point, b: Point) -> bool {
    let pins: Vec<Point> = placed(part).map(|(_, pin)| pin).collect();
    let &[c, d] = pins.as_slice() else { return false };
    let overlap = |a: f64, b: f64, c: f64, d: f64| a.max(b).min(c.max(d)) - a.min(b).max(c.min(d)) > 0.01;
    let level = a.1 == b.1 && c.1 == d.1 && a.1 == c.1 && overlap(a.0, b.0, c.0, d.0);
    level || (a.0 == b.0 && c.0 == d.0 && a.0 == c.0 && overlap(a.1, b.1, c.1, d.1))
}

/// Joins the pins of a net: from those joined already to the nearest that is not.
fn wires(svg: &mut String, sheet: &Sheet, net: &str, pins: &[Point]) {
    let distance = |a: Point, b: Point| (a.0 - b.0).abs() + (a.1 - b.1).abs();
    let Some((&first, rest)) = pins.split_first() else { return };
    let (mut joined, mut open) = (vec![first], rest.to_vec());
    let mut met: Vec<Point> = Vec::new();
    while !open.is_empty() {
        let pairs = joined.iter().flat_map(|&a| open.iter().enumerate().map(move |(place, &b)| (a, place, b)));
        let Some((from, place, to)) = pairs.min_by(|x, y| distance(x.0, x.2).total_cmp(&distance(y.0, y.2))) else {
            break;
        };
        if distance(from, to) > FAR {
            label(svg, to, net);
            label(svg, from, net);
        } else {
            line(svg, &way(sheet, from, to));
        }
        if met.contains(&from) {
            dot(svg, from);
        }
        met.extend([from, to]);
        joined.push(open.remove(place));
    }
    let (x, y) = pixel(first);
    let _ = writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"#06c\" stroke=\"none\">{net}</text>", x + 4.0, y - 5.0);
}

/// The part's symbol, name and value.
fn symbol(svg: &mut String, part: &Part) {
    let to = |points: &[Point]| points.iter().map(|&p| at(part, p)).collect::<Vec<_>>();
    let mut strokes: Vec<&[Point]> = Vec::new();
    match part.kind {
        Kind::Resistor | Kind::Coil => strokes.extend([
            &[(0.0, 0.0), (0.2, 0.0)][..],
            &[(0.8, 0.0), (1.0, 0.0)],
            &[(0.2, -0.12), (0.8, -0.12), (0.8, 0.12), (0.2, 0.12), (0.2, -0.12)],
        ]),
        Kind::Capacitor => strokes.extend([
            &[(0.0, 0.0), (0.45, 0.0)][..],
            &[(0.55, 0.0), (1.0, 0.0)],
            &[(0.45, -0.2), (0.45, 0.2)],
            &[(0.55, -0.2), (0.55, 0.2)],
        ]),
        Kind::Diode => strokes.extend([
            &[(0.0, 0.0), (1.0, 0.0)][..],
            &[(0.35, -0.2), (0.35, 0.2), (0.65, 0.0), (0.35, -0.2)],
            &[(0.65, -0.2), (0.65, 0.2)],
        ]),
        Kind::BreakContact => {
            strokes.extend([&[(0.0, 0.0), (0.2, 0.0), (0.85, -0.12)][..], &[(0.8, -0.25), (0.8, 0.0), (1.0, 0.0)]]);
        }
        Kind::OpAmp => strokes.extend([
            &[(0.0, -1.0), (0.0, 1.0), (2.0, 0.0), (0.0, -1.0)][..],
            &[(-0.5, -0.5), (0.0, -0.5)],
            &[(-0.5, 0.5), (0.0, 0.5)],
            &[(2.0, 0.0), (2.5, 0.0)],
            &[(0.1, -0.5), (0.3, -0.5)],
            &[(0.2, -0.6), (0.2, -0.4)],
            &[(0.1, 0.5), (0.3, 0.5)],
            &[(1.0, -0.75), (1.0, -0.5)],
            &[(1.0, 0.75), (1.0, 0.5)],
        ]),
        Kind::Mosfet => strokes.extend([
            &[(0.0, 0.0), (0.6, 0.0)][..],
            &[(0.6, -0.4), (0.6, 0.4)],
            &[(0.7, -0.4), (0.7, 0.4)],
            &[(0.7, -0.3), (1.0, -0.3), (1.0, -1.0)],
            &[(0.7, 0.3), (1.0, 0.3), (1.0, 1.0)],
        ]),
        Kind::Changeover => strokes.extend([
            &[(2.0, 0.0), (1.5, 0.0), (0.4, 0.85)][..],
            &[(0.0, -1.0), (0.4, -1.0), (0.4, -0.8)],
            &[(0.0, 1.0), (0.4, 1.0), (0.4, 0.8)],
        ]),
        Kind::Terminal => {}
    }
    for stroke in strokes {
        line(svg, &to(stroke));
    }
    if part.kind == Kind::Terminal {
        for (_, pin) in placed(part) {
            let (x, y) = pixel(pin);
            let _ = writeln!(svg, "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"10\" height=\"10\"/>", x - 5.0, y - 5.0);
        }
    }
    named(svg, part);
}

/// Name and value beside the symbol.
fn named(svg: &mut String, part: &Part) {
    let beside = match (part.kind, part.turn % 2) {
        (Kind::OpAmp, _) => (0.35, 0.1),
        (Kind::Terminal, _) => (-0.2, -0.6),
        (Kind::Mosfet, _) => (1.1, 0.1),
        (Kind::Changeover, _) => (0.7, -0.4),
        (_, 1) => (0.55, -0.2),
        _ => (0.1, -0.3),
    };
    let place = if part.turn % 2 == 1 { at(part, beside) } else { at(&Part { turn: 0, ..part.clone() }, beside) };
    let place = if part.turn % 2 == 1 { (at(part, (0.5, 0.0)).0 + 0.2, place.1) } else { place };
    let said = if part.kind == Kind::Coil { String::new() } else { engineering(part.value) };
    text(svg, pixel(place), format!("{} {said}", part.name).trim_end(), 12);
}
