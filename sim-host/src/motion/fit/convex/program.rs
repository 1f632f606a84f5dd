//! A cone program under construction, and what a solution proves.

use super::super::FitError;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// A linear expression: coefficients by variable.
pub(crate) type Terms<'a> = &'a [(usize, f64)];

/// Minimise x'Px/2 + q'x subject to rows of four kinds. Rows are kept by kind, since the solver wants them so.
#[derive(Debug, Default)]
pub(crate) struct Program {
    /// No variable can exceed this magnitude in any feasible point.
    reach: Vec<f64>,
    linear: Vec<f64>,
    quadratic: Triplets,
    equal: Rows,
    at_most: Rows,
    cones: Rows,
}

/// Entries of a sparse matrix.
#[derive(Debug, Default, Clone)]
struct Triplets {
    row: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
}

impl Triplets {
    fn push(&mut self, row: usize, column: usize, value: f64) {
        self.row.push(row);
        self.column.push(column);
        self.value.push(value);
    }
}

/// Rows `terms . x` against a right-hand side.
#[derive(Debug, Default)]
struct Rows {
    entries: Triplets,
    right: Vec<f64>,
}

impl Rows {
    fn push(&mut self, terms: Terms<'_>, right: f64) {
        let row = self.right.len();
        for &(column, value) in terms {
            self.entries.push(row, column, value);
        }
        self.right.push(right);
    }
}

/// A solved program.
pub(crate) struct Solution {
    /// The variables.
    pub(crate) x: Vec<f64>,
    /// No feasible point has a lower objective.
    pub(crate) bound: f64,
}

impl Program {
    /// `count` new variables that no feasible point takes beyond `reach`; gives the first's index.
    pub(crate) fn variables(&mut self, count: usize, reach: f64) -> usize {
        let first = self.reach.len();
        self.reach.resize(first + count, reach);
        self.linear.resize(first + count, 0.0);
        first
    }

    /// Adds `weight` times the variable to the objective.
    pub(crate) fn cost(&mut self, variable: usize, weight: f64) {
        self.linear[variable] += weight;
    }

    /// Adds (terms . x - target)^2 / 2 to the objective, its constant left out.
    pub(crate) fn least_squares(&mut self, terms: Terms<'_>, target: f64) {
        for &(i, a) in terms {
            self.linear[i] -= target * a;
            for &(j, b) in terms {
                if i <= j {
                    self.quadratic.push(i, j, a * b);
                }
            }
        }
    }

    /// terms . x = right.
    pub(crate) fn equal(&mut self, terms: Terms<'_>, right: f64) {
        self.equal.push(terms, right);
    }

    /// terms . x <= right.
    pub(crate) fn at_most(&mut self, terms: Terms<'_>, right: f64) {
        self.at_most.push(terms, right);
    }

    /// |terms . x| <= right.
    pub(crate) fn within(&mut self, terms: Terms<'_>, right: f64) {
        let turned: Vec<_> = terms.iter().map(|&(i, a)| (i, -a)).collect();
        self.at_most.push(terms, right);
        self.at_most.push(&turned, right);
    }

    /// `variable`^2 <= `bound`, as the cone |(2 variable, 1 - bound)| <= 1 + bound.
    pub(crate) fn square_at_most(&mut self, variable: usize, bound: usize) {
        self.cones.push(&[(bound, -1.0)], 1.0);
        self.cones.push(&[(variable, -2.0)], 0.0);
        self.cones.push(&[(bound, 1.0)], 1.0);
    }

    /// Solves to `tolerance`, relative.
    pub(crate) fn solve(&self, tolerance: f64) -> Result<Solution, FitError> {
        let n = self.reach.len();
        let p = matrix(n, n, &self.quadratic);
        let (a, b) = self.stacked();
        let cones = self.cone_list();
        let settings = DefaultSettings {
            verbose: false,
            max_iter: 100,
            tol_gap_abs: tolerance,
            tol_gap_rel: tolerance,
            tol_feas: tolerance,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&p, &self.linear, &a, &b, &cones, settings)
            .map_err(|e| FitError::Solver(e.to_string()))?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {}
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                return Err(FitError::Infeasible("the solver holds a certificate of it".into()));
            }
            other => return Err(FitError::Solver(format!("{other:?}"))),
        }
        let bound = self.lower_bound(&p, &a, &b, &solver.solution.x, &solver.solution.z);
        Ok(Solution { x: std::mem::take(&mut solver.solution.x), bound })
    }

    /// All rows below one another, and their right-hand sides.
    fn stacked(&self) -> (CscMatrix<f64>, Vec<f64>) {
        let mut all = Triplets::default();
        let mut right = Vec::new();
        for rows in [&self.equal, &self.at_most, &self.cones] {
            all.row.extend(rows.entries.row.iter().map(|r| r + right.len()));
            all.column.extend(&rows.entries.column);
            all.value.extend(&rows.entries.value);
            right.extend(&rows.right);
        }
        (matrix(right.len(), self.reach.len(), &all), right)
    }

    fn cone_list(&self) -> Vec<SupportedConeT<f64>> {
        let mut cones = vec![
            SupportedConeT::ZeroConeT(self.equal.right.len()),
            SupportedConeT::NonnegativeConeT(self.at_most.right.len()),
        ];
        cones.resize(2 + self.cones.right.len() / 3, SupportedConeT::SecondOrderConeT(3));
        cones
    }

    /// Weak duality with no trust in the solver: for any z in the dual cone and any x, every feasible point y satisfies
    /// f(y) >= f(y) + z'(Ay - b) >= -x'Px/2 - b'z + g'y with g = Px + q + A'z, and |y| <= `reach` bounds the last term.
    fn lower_bound(&self, p: &CscMatrix<f64>, a: &CscMatrix<f64>, b: &[f64], x: &[f64], z: &[f64]) -> f64 {
        let z = self.in_dual_cone(z);
        let mut gradient = self.linear.clone();
        let mut curved = vec![0.0; x.len()];
        for (i, j, v) in entries(p) {
            curved[i] += v * x[j];
            if i != j {
                curved[j] += v * x[i];
            }
        }
        for (i, j, v) in entries(a) {
            gradient[j] += v * z[i];
        }
        let mut bound = 0.0;
        for i in 0..x.len() {
            bound -= 0.5 * x[i] * curved[i] + (gradient[i] + curved[i]).abs() * self.reach[i];
        }
        bound - b.iter().zip(&z).map(|(b, z)| b * z).sum::<f64>()
    }

    /// The nearest multipliers that are admissible.
    fn in_dual_cone(&self, z: &[f64]) -> Vec<f64> {
        let (equal, at_most) = (self.equal.right.len(), self.at_most.right.len());
        let mut z = z.to_vec();
        for z in &mut z[equal..equal + at_most] {
            *z = z.max(0.0);
        }
        for cone in z[equal + at_most..].chunks_exact_mut(3) {
            cone[0] = cone[0].max(cone[1].hypot(cone[2]));
        }
        z
    }
}

/// A matrix from its entries, repeated ones added.
fn matrix(rows: usize, columns: usize, entries: &Triplets) -> CscMatrix<f64> {
    CscMatrix::new_from_triplets(rows, columns, entries.row.clone(), entries.column.clone(), entries.value.clone())
}

/// Row, column and value of every entry.
fn entries(matrix: &CscMatrix<f64>) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    (0..matrix.n).flat_map(move |column| {
        (matrix.colptr[column]..matrix.colptr[column + 1]).map(move |k| (matrix.rowval[k], column, matrix.nzval[k]))
    })
}
