//! The valve's edges and the supply: limits, their corners, droop, and the pressure that the load takes.

mod edges;
mod limit;
mod supply;

use super::{Dial, Form, Needs, Parameters, SATURATION, SERVO};
use crate::lab::plant::Plant;

const fn form(
    effect: &'static str,
    name: &'static str,
    source: &'static str,
    build: fn(&mut Plant, &Dial) -> Parameters,
    needs: Needs,
) -> Form {
    Form { effect, name, source, build, needs }
}

pub(super) const FORMS: &[Form] = &[
    form("flow_softening", "two restrictions in a row", "soft minimum of two limits", limit::soft_minimum, SATURATION),
    form("flow_softening", "port that runs out", "tanh over the last part of the opening", limit::knee, SATURATION),
    form("flow_softening", "line in front of the valve", "squared resistances in series", limit::line, SATURATION),
    form("asymmetric_limit", "unequal areas", "limits either side, rounded corner", limit::sides, SATURATION),
    form("asymmetric_limit", "one side throttled", "squared resistance in one direction", limit::throttled, SATURATION),
    form("asymmetric_limit", "spool stops", "limits either side that creep with time", limit::creeping, SATURATION),
    form(
        "supply_droop",
        "gas and pump",
        "polytropic accumulator, pressure-compensated pump",
        supply::polytropic,
        SATURATION,
    ),
    form("supply_droop", "line and accumulator", "accumulator behind a turbulent line", supply::line, SATURATION),
    form("supply_droop", "loading pump", "pump that loads and unloads by pressure", supply::loading, SATURATION),
    form("load_dependent_flow", "four edges", "orifice at each edge, two chambers", edges::four_edges, SERVO),
    form(
        "load_dependent_flow",
        "orifice with laminar start",
        "one loaded edge, laminar below a pressure",
        edges::laminar,
        SERVO,
    ),
    form("load_dependent_flow", "back pressure", "orifice against a return line", edges::back_pressure, SERVO),
];

#[cfg(test)]
mod tests {
    use super::super::of;
    use crate::lab::plant::Plant;
    use crate::lab::testing::{dial, held, servo};

    #[test]
    fn far_beyond_the_limit_the_table_runs_at_it_and_far_below_it_at_the_demand() {
        for form in of("flow_softening") {
            let mut plant = Plant::baseline(servo());
            (form.build)(&mut plant, &dial(0.4));
            let (fast, slow) = (held(&plant, 0.6, 1.0), held(&plant, 0.01, 1.0));
            assert!((fast / 0.242 - 1.0).abs() < 0.12, "{}: {fast} m/s at the limit", form.name);
            let stated = held(&Plant::baseline(servo()), 0.01, 1.0);
            assert!((slow / stated - 1.0).abs() < 0.05, "{}: {slow} m/s for {stated}", form.name);
        }
    }

    #[test]
    fn the_two_limits_are_those_stated() {
        for form in of("asymmetric_limit") {
            let mut plant = Plant::baseline(servo());
            let stated = (form.build)(&mut plant, &dial(0.5));
            let (there, back) = (held(&plant, 0.6, 1.0), -held(&plant, -0.6, 1.0));
            assert!((there / stated[0].1 - 1.0).abs() < 0.08, "{}: {there} for {}", form.name, stated[0].1);
            assert!((back / stated[1].1 - 1.0).abs() < 0.08, "{}: {back} for {}", form.name, stated[1].1);
        }
    }

    #[test]
    fn the_supply_sinks_under_a_long_draught_and_the_table_with_it() {
        for form in of("supply_droop") {
            let mut plant = Plant::baseline(servo());
            let depth = (form.build)(&mut plant, &dial(0.4))[0].1;
            let kept = held(&plant, 0.6, 30.0) / 0.242;
            assert!(kept < 1.0 - 0.2 * depth && kept > 1.0 - 1.2 * depth, "{}: {kept} for depth {depth}", form.name);
        }
    }

    #[test]
    fn an_unloaded_edge_passes_its_demand() {
        for form in of("load_dependent_flow") {
            let mut plant = Plant::baseline(servo());
            (form.build)(&mut plant, &dial(0.3));
            let ratio = held(&plant, 0.03, 1.0) / held(&Plant::baseline(servo()), 0.03, 1.0);
            assert!((ratio - 1.0).abs() < 0.03, "{}: {ratio}", form.name);
        }
    }
}
