//! The numbers that decide, in one place, each with what it estimates.
//!
//! They are properties of models and laboratories, not of an examination: how much a right effect in another equation leaves,
//! how much a wrong one takes away, how wrong stated figures are. What bounds a search (how many candidates are looked at)
//! stands where it is used: it costs time, not truth.

/// What decides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Calibration {
    /// Degrees of freedom with which the share that a simple form leaves is known: the odds of two effects whose leftovers
    /// have the ratio r are r to half of this, on training and validation each.
    pub(super) form_freedom: f64,
    /// Share of the stated model's excess below which nothing is known of what a simple form leaves but that it may be of any order: two
    /// equations are distinguished there by that order alone.
    pub(super) form_least: f64,
    /// Share of what an effect explains that its simple form may leave near the noise: another that leaves no more is not told apart by that.
    pub(super) form_most: f64,
    /// What a fitted parameter must earn, as twice a log likelihood.
    pub(super) parameter_price: f64,
    /// Standard deviation of a stated value that may be fitted, as a share of it.
    pub(super) stated_share: f64,
    /// Share of the stated model's excess that must be explained for a name to stand alone.
    pub(super) explained: f64,
    /// Share of what the present model leaves that one more effect must take away: strangers take less.
    pub(super) worth: f64,
    /// Share of the stated model's excess that one more effect must take away: simple forms leave about as much of a real one.
    pub(super) noticeable: f64,
    /// The same of one that takes away most of what is left on either kind of runs: what a simple form leaves looks seldom that much like
    /// another effect.
    pub(super) telling: f64,
    /// Share of what is left that such an effect may leave.
    pub(super) told: f64,
    /// Share of the stated model's excess that an effect may explain alone to be distinguished from another that explains it: one that is
    /// nothing like it may stand beside it for less than what is noticeable, where it explains nearly all that is left.
    pub(super) distinct: f64,
    /// Excess of chi2 in which another effect may hide beneath a gross one: noise leaves less.
    pub(super) hidden: f64,
    /// Share of what is still left that an effect must have taken away: what explains less is a stranger to the mismatch.
    pub(super) credible: f64,
    /// Excess of chi2 that is never called physics: noise is not known better.
    pub(super) negligible: f64,
    /// chi2 up to which what follows nothing is noise that was stated too small.
    pub(super) modest: f64,
    /// The same of a channel whose noise nobody states: of a noise that swings slowly neighbouring samples show little.
    pub(super) unstated: f64,
    /// Share of a named effect's excess beyond which what is left and follows the motion is said to be missing too.
    pub(super) simple: f64,
    /// Share of the stated model's excess that names must explain to be given where more is missing beside them.
    pub(super) most: f64,
    /// How many times as much any other set of their size must leave for that.
    pub(super) lead: f64,
    /// Probability of names that explain a part where more is missing.
    pub(super) beside_more: f64,
    /// Probability that what names explain but for a rest beyond the noise is something else that looks like them.
    pub(super) mimicked: f64,
    /// Probability that nothing of the library is right where what was selected failed on the runs held out.
    pub(super) failed: f64,
    /// Probability below which a name is not given, unless it and those that it is mistaken for are likelier than not together.
    pub(super) unlikely: f64,
    /// Share of what the accepted model left that an effect in a region may leave at most.
    pub(super) region: f64,
    /// The same where one name was enough without: a simple form leaves something of every effect, of which a region takes away a part.
    pub(super) region_of_a_name: f64,
    /// What speaks against a clock at another rate, as twice a logarithm: one laboratory in ten; and the rate that one is off by, as a
    /// standard deviation.
    pub(super) clock_odds: f64,
    pub(super) clock_rate: f64,
    /// What gains of a controller are stated wrong by, as a share: a standard deviation.
    pub(super) misstated_gain: f64,
    /// Log odds below which two models are not told apart.
    pub(super) tie: f64,
}

/// Set by judgement over open cases of both examiners (seeds 9001, 77, 501, 6102, 7301, 6173, 8081, 8083, 8118 and 8119, burnt for that); no fit has made them yet, and
/// probabilities that rest on them are not calibrated.
pub(super) const CALIBRATION: Calibration = Calibration {
    form_freedom: 8.0,
    form_least: 1e-3,
    form_most: 0.3,
    parameter_price: 4.0,
    stated_share: 0.2,
    explained: 0.9,
    worth: 0.65,
    noticeable: 0.018,
    telling: 0.0025,
    told: 0.3,
    distinct: 0.3,
    hidden: 0.15,
    credible: 0.15,
    negligible: 0.06,
    modest: 2.5,
    unstated: 25.0,
    simple: 0.07,
    most: 0.8,
    lead: 4.0,
    beside_more: 0.6,
    mimicked: 0.08,
    failed: 0.9,
    unlikely: 0.1,
    region: 0.5,
    region_of_a_name: 0.1,
    clock_odds: 4.6,
    clock_rate: 2e-3,
    misstated_gain: 0.02,
    tie: 3.0,
};
