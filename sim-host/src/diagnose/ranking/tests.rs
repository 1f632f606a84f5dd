use super::super::decide::tests::{judged, leaving};
use super::*;
use crate::identify::fit::tests::{TRUTH, model, recorded};

/// What speaks for the first of two models against the second, where the stated one leaves so much.
fn apart(stated: f64, first: f64, second: f64) -> f64 {
    let runs: Vec<_> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
    let template = judged(model(TRUTH), &runs);
    let [before, first, second] = [stated, first, second].map(|chi2| leaving(chi2, &template));
    let ranking = Ranking::new(&before, [&first, &second]);
    ranking.cost(&second) - ranking.cost(&first)
}

/// Beneath a gross mismatch a model that leaves nothing is distinguished from one that leaves twelve times the noise, though of the mismatch either is
/// next to nothing; two that leave about as much are not distinguished there, nor two that leave what noise may be.
#[test]
fn a_model_that_leaves_nothing_is_told_from_one_that_leaves_little() {
    assert!(apart(5e5, 1.0, 13.0) > 2.0 * CALIBRATION.tie);
    assert!(apart(5e5, 13.0, 25.0) < CALIBRATION.tie);
    assert!(apart(5e5, 1.0, 1.03) < CALIBRATION.tie);
}

/// Where the whole mismatch is near the noise no form is wider than chance, and ratios count as Student's likelihood has them; beneath a
/// gross one more left always speaks against more.
#[test]
fn near_the_noise_no_form_is_wider_than_chance() {
    let student = |excess: f64| CALIBRATION.form_freedom * (excess / 0.02).ln_1p();
    for excess in [0.0, 0.01, 0.3] {
        assert!((against(excess, 0.02, 0.0) - student(excess)).abs() < 1e-9);
    }
    let costs: Vec<f64> = (0..60).map(|i| against(0.01 * 1.3_f64.powi(i), 0.02, 500.0)).collect();
    assert!(costs.windows(2).all(|w| w[1] > w[0]), "{costs:?}");
}
