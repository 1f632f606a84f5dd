//! Largest speed from flow, pressure drop and area (Eq. 8).

use super::super::Failure;
use super::super::failure::within;
use super::super::present::Part;
use crate::plant::slew_rate::Valve;
use crate::report::{Item, Section};
use serde_json::json;

/// The valve and the piston.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Flow of the valves, L/s [default: the paper's 7.7, brought to 6.57 by the pressure drop at work].
    #[arg(long, value_name = "L/S")]
    flow: Option<f64>,
    /// Pressure drop across the valves at work over the one `--flow` is rated at; the flow goes with its square root
    /// [default: 1 with --flow].
    #[arg(long, value_name = "RATIO")]
    drop_ratio: Option<f64>,
    /// Effective area of the piston, cm2.
    #[arg(long, value_name = "CM2", default_value_t = Valve::PAPER.area * 1e4)]
    area: f64,
}

impl Args {
    /// Flow, L/s, and the ratio of pressure drops.
    fn values(&self) -> (f64, f64) {
        let (paper, own) = (Valve::PAPER, self.flow.is_some());
        let flow = self.flow.unwrap_or(paper.rated_flow * 1e3);
        (flow, self.drop_ratio.unwrap_or(if own { 1.0 } else { paper.drop_ratio }))
    }

    /// Refuses what no valve and no piston has.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let (flow, drop_ratio) = self.values();
        within("--flow", flow, 1e-3, 1e5, "L/s")?;
        within("--drop-ratio", drop_ratio, 1e-3, 1e3, "")?;
        within("--area", self.area, 0.1, 1e6, "cm2")
    }
}

/// Works Eq. 8 out.
pub(super) fn run(args: &Args) -> Part {
    let (flow, drop_ratio) = args.values();
    let valve = Valve { rated_flow: flow * 1e-3, drop_ratio, area: args.area * 1e-4 };
    let items = vec![
        Item::Tiles(vec![
            ("rated flow".into(), format!("{flow:.2} L/s")),
            ("flow at work".into(), format!("{:.2} L/s", valve.flow() * 1e3)),
            ("piston area".into(), format!("{:.0} cm2", args.area)),
            ("largest speed".into(), format!("{:.3} m/s", valve.slew_rate())),
        ]),
        Item::Note(
            "The paper's text says 6.5 L/s and its Eq. 8 computes with 6.57, giving 0.274 m/s; its table showed 0.242. It \
             names the area (taken from outside diameters), friction and the pressure drop as causes."
                .into(),
        ),
    ];
    let json = json!({"flow_m3_per_s": valve.flow(), "area_m2": valve.area, "slew_rate_m_per_s": valve.slew_rate()});
    let figure = ("largest speed (Eq. 8)".to_owned(), format!("{:.3} m/s", valve.slew_rate()));
    let found = format!("The valve lets the piston go {:.3} m/s at most.", valve.slew_rate());
    let section = Section { heading: "Slew rate (Eq. 8)".into(), items };
    Part { key: "slew_rate", json, found, figure, section, inputs: Vec::new() }
}
