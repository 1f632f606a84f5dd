//! How far a run that has not been made would part a model from another.

use super::Fit;
use crate::identify::data::Run;
use crate::identify::evaluate::{Local, normal};
use crate::plant::simulate::SimulateError;
use nalgebra::DMatrix;

impl Fit {
    /// The least squares (1, in units of noise) that a run would add to this fit, its shared values moved to meet the new
    /// run as far as the runs fitted so far let them, its own start free. With another model's prediction for the
    /// run's measurements this is the squared distance at which the run would hold the two models: the criterion of
    /// T-optimal design (Atkinson and Fedorov, 1975), linear in the values.
    pub fn parted_by(&self, run: &Run) -> Result<f64, SimulateError> {
        let mut new = normal(&self.model, run, &Local::start(&self.model, run), None)?;
        if let Some(known) = self.information() {
            let shared = known.nrows();
            let mut corner = new.matrix.view_mut((0, 0), (shared, shared));
            corner += known;
        }
        let step = new.step(1e-9, &vec![false; new.gradient.len()]);
        Ok((new.squares - step.map_or(0.0, |step| step.dot(&new.gradient))).max(0.0))
    }

    /// What the runs fitted so far know of the shared values: the inverse of their covariance.
    fn information(&self) -> Option<DMatrix<f64>> {
        let shared = self.model.free_values();
        let inverse = self.normal.inverse()?.view((0, 0), (shared, shared)).into_owned();
        inverse.try_inverse()
    }
}
