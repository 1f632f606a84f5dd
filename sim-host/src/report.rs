//! One HTML page that opens with no network: figures that zoom, tables, notes. Knows nothing of what it shows.
//!
//! Everything flows one way: a command fills a [`Page`] with values in SI or display units of its choice, every axis
//! and column naming its unit, and writes it.

#[cfg(test)]
mod contrast;
mod curve;
mod escape;
mod figure;
mod html;
mod matrix;
mod svg;
pub mod terminal;

use std::path::Path;

/// One HTML page under construction.
#[derive(Debug, Clone, Default)]
pub struct Page {
    /// Title, at the top and in the tab.
    pub title: String,
    /// The verdict: one or two sentences that say what came out.
    pub lead: String,
    /// The figures that matter most: label, value with unit.
    pub key: Vec<(String, String)>,
    /// What to do next, in the order of its use.
    pub advice: Vec<String>,
    /// Sections in reading order.
    pub sections: Vec<Section>,
    /// Sections for who wants to know more: they stand folded below the others.
    pub details: Vec<Section>,
    /// Where everything came from: version, seed, input files and their SHA-256.
    pub provenance: Vec<(String, String)>,
}

/// A heading and what is below it.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// The heading.
    pub heading: String,
    /// Contents in reading order.
    pub items: Vec<Item>,
}

/// One thing in a section.
#[derive(Debug, Clone)]
pub enum Item {
    /// A paragraph of plain text.
    Text(String),
    /// A remark set apart: a caveat, a cause, a remedy.
    Note(String),
    /// Large figures at a glance: label, value with unit.
    Tiles(Vec<(String, String)>),
    /// A table.
    Table(Table),
    /// A figure.
    Plot(Plot),
    /// Counts or shares in two directions, shaded.
    Matrix(Matrix),
}

/// A table; numbers arrive formatted, with units in the header.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Column headers with units.
    pub columns: Vec<String>,
    /// Rows of cells.
    pub rows: Vec<Vec<String>>,
    /// What the table shows.
    pub caption: String,
}

/// What a cell of a matrix is shaded by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Shade {
    /// Its share of its row, as of a confusion matrix.
    #[default]
    OfRow,
    /// Its share of the largest value.
    OfLargest,
}

/// A table of numbers in two directions, each cell shaded.
#[derive(Debug, Clone, Default)]
pub struct Matrix {
    /// What it shows.
    pub caption: String,
    /// What the rows are, for instance `truth`.
    pub rows_are: String,
    /// What the columns are, for instance `answer`.
    pub columns_are: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Name of each row and one value a column; NaN leaves a cell empty.
    pub rows: Vec<(String, Vec<f64>)>,
    /// What a cell is shaded by.
    pub shade: Shade,
}

/// A figure: curves over one abscissa.
#[derive(Debug, Clone, Default)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// The curves, each with its own abscissa values.
    pub series: Vec<Series>,
    /// Stretches of the abscissa to shade, for instance where the valve saturates.
    pub bands: Vec<Band>,
    /// Plots that share a group zoom together.
    pub group: Option<String>,
    /// The stretch of the abscissa that is shown first, such as the strong motion; all of it is one key away.
    pub open: Option<(f64, f64)>,
}

/// One axis.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// Label with unit, for instance `time [s]`.
    pub label: String,
    /// Logarithmic scale.
    pub log: bool,
}

/// One curve.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Abscissa values.
    pub x: Vec<f64>,
    /// Ordinate values; NaN leaves a gap.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub style: Style,
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Style {
    /// A solid line.
    #[default]
    Line,
    /// A dashed line: a reference or a limit.
    Dashed,
    /// Points only.
    Points,
    /// A thin pale line: raw data behind the curve that matters.
    Faint,
}

/// A shaded stretch of the abscissa.
#[derive(Debug, Clone, Default)]
pub struct Band {
    /// Where it starts.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// What it marks.
    pub label: String,
}

impl Plot {
    /// The figure by itself as SVG; none where it has nothing to show.
    pub fn svg(&self) -> Option<String> {
        svg::figure(self)
    }
}

impl Page {
    /// Its figures, in the order of the page.
    pub fn plots(&self) -> impl Iterator<Item = &Plot> {
        let items = self.sections.iter().chain(&self.details).flat_map(|section| &section.items);
        items.filter_map(|item| if let Item::Plot(plot) = item { Some(plot) } else { None })
    }

    /// The whole page as text: style, scripts and data inside, no request leaves it.
    pub fn html(&self) -> String {
        html::page(self)
    }

    /// Writes the page, whole or not at all.
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        crate::files::write_whole(path, self.html().as_bytes())
    }
}
