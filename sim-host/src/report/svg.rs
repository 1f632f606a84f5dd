//! A figure by itself as SVG, for a document: axes, curves, bands and legend, with no script and no font of its own.

use std::fmt::Write as _;

use super::escape::text;
use super::{Axis, Plot, Style};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 380.0;
/// Left, right, top and bottom of the frame.
const FRAME: [f64; 4] = [74.0, 884.0, 62.0, 330.0];
/// Most points of a curve: several a pixel.
const POINTS: usize = 2400;
/// Curves by their place, the same as on a page; they stay apart under every colour blindness.
const COLOURS: [&str; 7] = ["#0b57ad", "#e4560a", "#0d9c7c", "#7b2a66", "#97870a", "#5f93dd", "#80260f"];
const SHADES: [&str; 3] = ["#f2dcae", "#e2d0e8", "#dcdde0"];
/// Decades shown at most below the largest value of a logarithmic axis.
const DECADES: i32 = 8;

/// One axis: from data to the picture.
struct Scale {
    log: bool,
    from: f64,
    to: f64,
    at: [f64; 2],
}

impl Scale {
    /// Over `values`; `spare` is the share of the span that is left free at either end.
    fn over(values: impl Iterator<Item = f64>, log: bool, at: [f64; 2], spare: f64) -> Option<Self> {
        let shown = values.filter(|v| v.is_finite() && (!log || *v > 0.0)).map(|v| if log { v.log10() } else { v });
        let (low, high) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if low > high {
            return None;
        }
        let low = if log { low.max(high - f64::from(DECADES)) } else { low };
        let span = if high > low { high - low } else { high.abs().max(1e-12) };
        Some(Self { log, from: low - spare * span, to: high + spare * span, at })
    }

    fn place(&self, value: f64) -> f64 {
        let value = if self.log { value.max(f64::MIN_POSITIVE).log10() } else { value };
        self.at[0] + (value - self.from) / (self.to - self.from) * (self.at[1] - self.at[0])
    }

    /// Where marks go, with their words.
    fn marks(&self, most: f64) -> Vec<(f64, String)> {
        let rough = (self.to - self.from) / most;
        let decade = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * decade).find(|s| *s >= rough).unwrap_or(rough);
        if self.log && step < 1.0 && self.to - self.from < 1.5 {
            // Less than two decades: ones, twos and fives.
            let decades = (self.from.floor() as i32)..=(self.to.ceil() as i32);
            let all = decades.flat_map(|d| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(d)));
            return all.filter(|v| (self.from..=self.to).contains(&v.log10())).map(|v| (v, words(v, v))).collect();
        }
        let step = if self.log { step.max(1.0).round() } else { step };
        let (first, last) = ((self.from / step).ceil() as i64, (self.to / step + 1e-9).floor() as i64);
        (first..=last)
            .map(|k| k as f64 * step)
            .map(|v| if self.log { (10f64.powf(v), words(10f64.powf(v), 10f64.powf(v))) } else { (v, words(v, step)) })
            .collect()
    }
}

/// A number at a mark, to the digits of the step.
fn words(value: f64, step: f64) -> String {
    if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:e}");
    }
    let digits = (-(step.abs().log10() + 1e-9).floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}

/// The figure; none where it has nothing to show.
pub(super) fn figure(plot: &Plot) -> Option<String> {
    let [left, right, top, bottom] = FRAME;
    let open = plot.open.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let inside = |x: f64| (open.0..=open.1).contains(&x);
    let xs = plot.series.iter().flat_map(|s| s.x.iter().copied()).filter(|x| inside(*x));
    let ys = plot.series.iter().flat_map(|s| s.x.iter().zip(&s.y)).filter(|(x, _)| inside(**x)).map(|(_, y)| *y);
    let x = Scale::over(xs, plot.x.log, [left, right], 0.0)?;
    let y = Scale::over(ys, plot.y.log, [bottom, top], 0.05)?;
    let mut out = String::new();
    let title = text(&plot.title);
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" font-family=\"system-ui, sans-serif\" \
         font-size=\"13\"><title>{title}</title>\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fcfcfa\"/>\n\
         <text x=\"{left}\" y=\"22\" font-weight=\"600\" fill=\"#1b1f24\">{title}</text>\n"
    );
    bands(&mut out, plot, &x);
    axes(&mut out, plot, &x, &y);
    curves(&mut out, plot, &x, &y);
    out.push_str("</svg>\n");
    Some(out)
}

fn bands(out: &mut String, plot: &Plot, x: &Scale) {
    let [left, right, top, bottom] = FRAME;
    let mut labels: Vec<&str> = plot.bands.iter().map(|band| band.label.as_str()).collect();
    labels.dedup();
    for band in &plot.bands {
        let (from, to) = (x.place(band.from).clamp(left, right), x.place(band.to).clamp(left, right));
        let shade = SHADES[labels.iter().position(|label| *label == band.label).unwrap_or(0) % SHADES.len()];
        let (width, height) = ((to - from).max(0.0), bottom - top);
        let _ = writeln!(
            out,
            "<rect x=\"{from:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height}\" fill=\"{shade}\"/>"
        );
    }
}

fn axes(out: &mut String, plot: &Plot, x: &Scale, y: &Scale) {
    let [left, right, top, bottom] = FRAME;
    for (value, words) in x.marks(9.0) {
        let at = x.place(value);
        let _ = writeln!(
            out,
            "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#e6e6e0\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\" fill=\"#5c646e\">{words}</text>",
            bottom + 17.0
        );
    }
    for (value, words) in y.marks(6.0) {
        let at = y.place(value);
        let _ = writeln!(
            out,
            "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#e6e6e0\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#5c646e\">{words}</text>",
            left - 7.0,
            at + 4.5
        );
    }
    let named = |axis: &Axis| text(&axis.label);
    let _ = writeln!(
        out,
        "<path d=\"M{left} {top}V{bottom}H{right}\" fill=\"none\" stroke=\"#8a9096\"/>\n<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\" \
         fill=\"#1b1f24\">{}</text>\n<text transform=\"translate(17 {:.1}) rotate(-90)\" text-anchor=\"middle\" fill=\"#1b1f24\">{}</text>",
        f64::midpoint(left, right),
        HEIGHT - 10.0,
        named(&plot.x),
        f64::midpoint(top, bottom),
        named(&plot.y)
    );
}

fn curves(out: &mut String, plot: &Plot, x: &Scale, y: &Scale) {
    let [left, right, top, bottom] = FRAME;
    let _ = writeln!(out, "<clipPath id=\"frame\"><path d=\"M{left} {top}H{right}V{bottom}H{left}Z\"/></clipPath>");
    let (mut place, mut entry) = (0, left);
    for series in &plot.series {
        let (colour, width, dash) = match series.style {
            Style::Faint => ("#8b9096", 1.2, ""),
            Style::Dashed => ("#30353b", 1.3, " stroke-dasharray=\"6 4\""),
            Style::Line | Style::Points => {
                place += 1;
                (COLOURS[(place - 1) % COLOURS.len()], 1.7, "")
            }
        };
        let path = path(&series.x, &series.y, x, y, series.style == Style::Points);
        let cap = if series.style == Style::Points { " stroke-linecap=\"round\"" } else { "" };
        let width = if series.style == Style::Points { 3.6 } else { width };
        let _ = writeln!(
            out,
            "<path clip-path=\"url(#frame)\" d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{cap}{dash}/>\n\
             <path d=\"M{entry:.0} 42h22\" stroke=\"{colour}\" stroke-width=\"{width}\"{cap}{dash}/><text x=\"{:.0}\" y=\"46.5\" fill=\"#1b1f24\">{}</text>",
            entry + 28.0,
            text(&series.name)
        );
        entry += 50.0 + 7.2 * series.name.chars().count() as f64;
    }
}

/// The points of a curve; of a long one the smallest and the largest of each stretch.
fn path(xs: &[f64], ys: &[f64], x: &Scale, y: &Scale, points: bool) -> String {
    let low = |at: [f64; 2]| at[0].min(at[1]) - 50.0;
    let high = |at: [f64; 2]| at[0].max(at[1]) + 50.0;
    let mut out = String::new();
    let mut pen = false;
    for k in kept(ys) {
        let (Some(&a), Some(&b)) = (xs.get(k), ys.get(k)) else { break };
        let (a, b) = (x.place(a), if y.log && b <= 0.0 { f64::NAN } else { y.place(b) });
        if !a.is_finite() || !b.is_finite() || a < low(x.at) || a > high(x.at) {
            pen = false;
            continue;
        }
        let b = b.clamp(low(y.at), high(y.at));
        let _ = match (points, pen) {
            (true, _) => write!(out, "M{a:.1} {b:.1}h0"),
            (false, true) => write!(out, "L{a:.1} {b:.1}"),
            (false, false) => write!(out, "M{a:.1} {b:.1}"),
        };
        pen = true;
    }
    out
}

fn kept(ys: &[f64]) -> Vec<usize> {
    let stretch = (2 * ys.len()).div_ceil(POINTS).max(1);
    if stretch < 3 {
        return (0..ys.len()).collect();
    }
    let starts = (0..ys.len()).step_by(stretch);
    let extremes = starts.flat_map(|from| {
        let to = ys.len().min(from + stretch);
        let by = |a: &usize, b: &usize| ys[*a].total_cmp(&ys[*b]);
        let (low, high) = ((from..to).min_by(by).unwrap_or(from), (from..to).max_by(by).unwrap_or(from));
        if low < high { [low, high] } else { [high, low] }
    });
    extremes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Band, Series};

    fn plot(log: bool, y: Vec<f64>) -> Plot {
        let x = (0..y.len()).map(|k| k as f64 + 1.0).collect();
        Plot {
            title: "A <b> & c".into(),
            x: Axis { label: "time [s]".into(), log },
            y: Axis { label: "displacement [mm]".into(), log },
            series: vec![Series { name: "measured".into(), x, y, style: Style::Line }],
            bands: vec![Band { from: 2.0, to: 3.0, label: "saturated".into() }],
            ..Plot::default()
        }
    }

    #[test]
    fn a_figure_has_axes_with_units_and_every_extreme() {
        let mut y = vec![0.0; 50_000];
        y[31_234] = 7.0;
        y[12] = -3.0;
        let svg = figure(&plot(false, y)).unwrap();
        assert!(svg.contains("A &lt;b&gt; &amp; c") && svg.contains("time [s]") && svg.contains("displacement [mm]"));
        assert!(svg.len() < 100_000, "{}", svg.len());
        // The spike reaches the top of the frame less the spare, the dip its bottom.
        let ordinates: Vec<f64> = svg
            .split("<path clip-path=")
            .nth(1)
            .unwrap()
            .split(['L', 'M'])
            .filter_map(|part| part.split(' ').nth(1)?.trim_end_matches('"').parse().ok())
            .collect();
        let top = ordinates.iter().copied().fold(f64::INFINITY, f64::min);
        let bottom = ordinates.iter().copied().fold(0.0, f64::max);
        assert!(top < FRAME[2] + 15.0 && bottom > FRAME[3] - 15.0, "{top} {bottom}");
    }

    #[test]
    fn gaps_stay_gaps_and_what_a_logarithm_cannot_show_is_left_out() {
        let svg = figure(&plot(false, vec![1.0, f64::NAN, 2.0])).unwrap();
        let curve = svg
            .split("d=\"")
            .find(|part| part.starts_with('M') && part.contains("fill=\"none\" stroke=\"#0b57ad\""))
            .unwrap();
        assert_eq!(curve.split('"').next().unwrap().matches('M').count(), 2, "{curve}");
        assert!(figure(&plot(true, vec![0.0, -1.0])).is_none());
        let log = figure(&plot(true, vec![1e-18, 1.0, 10.0])).unwrap();
        assert!(!log.contains("1e-18"), "no eighteen decades");
    }
}
