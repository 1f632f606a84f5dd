//! Arrays: numbers, text, cells and structures, nested as they come.

use super::element::{self, Order};
use super::{Flaw, MAX_COLUMNS};

/// How deep structures and cells may nest.
const MAX_DEPTH: usize = 16;

/// Numbers column by column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Values {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) data: Vec<f64>,
}

/// An array.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Numbers(Values),
    Text(String),
    Cells(Vec<Node>),
    /// Each element of the structure array: its fields by name.
    Structures(Vec<Vec<(String, Node)>>),
    /// Complex, sparse, objects, functions: nothing a recording's channel can be.
    Other,
}

impl Node {
    /// Numbers it holds in all.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.data.len(),
            Self::Text(_) | Self::Other => 0,
            Self::Cells(cells) => cells.iter().map(Self::len).sum(),
            Self::Structures(elements) => elements.iter().flatten().map(|(_, node)| node.len()).sum(),
        }
    }
}

/// The array in an element's bytes, with its name.
pub(super) fn parse(bytes: &[u8], order: Order) -> Result<(String, Node), Flaw> {
    let mut budget = 10 * MAX_COLUMNS;
    array(bytes, order, 0, &mut budget)
}

fn array(bytes: &[u8], order: Order, depth: usize, budget: &mut usize) -> Result<(String, Node), Flaw> {
    // An empty element stands for an empty array.
    if bytes.is_empty() {
        return Ok((String::new(), Node::Other));
    }
    if depth > MAX_DEPTH || *budget == 0 {
        return Err("holds structures that are nested too deep or too many".to_owned());
    }
    *budget -= 1;
    let mut rest = bytes;
    let flags = element::take(&mut rest, order)?;
    let word = order.u32(flags.bytes.get(..4).unwrap_or_default());
    let (class, complex) = (word & 0xff, word & 0x0800 != 0);
    let dimensions: Vec<usize> = element::take(&mut rest, order)?.numbers(order)?.iter().map(|d| *d as usize).collect();
    let name = element::take(&mut rest, order)?.text(order)?;
    let count = dimensions.iter().try_fold(1usize, |product, &d| product.checked_mul(d));
    let count = count.ok_or_else(|| format!("gives `{name}` impossible dimensions {dimensions:?}"))?;
    let node = match class {
        1 => Node::Cells(arrays(&mut rest, order, depth, budget, count)?),
        2 => structures(&mut rest, order, depth, budget, count)?,
        4 => Node::Text(element::take(&mut rest, order)?.text(order)?),
        6..=15 if !complex => numbers(&mut rest, order, &dimensions, count, &name)?,
        _ => Node::Other,
    };
    Ok((name, node))
}

fn arrays(rest: &mut &[u8], order: Order, depth: usize, budget: &mut usize, count: usize) -> Result<Vec<Node>, Flaw> {
    let mut nodes = Vec::new();
    for _ in 0..count {
        let inner = element::take(rest, order)?;
        nodes.push(array(inner.bytes, order, depth + 1, budget)?.1);
        *budget = budget.checked_sub(1).ok_or_else(|| "holds too many cells".to_owned())?;
    }
    Ok(nodes)
}

fn structures(rest: &mut &[u8], order: Order, depth: usize, budget: &mut usize, count: usize) -> Result<Node, Flaw> {
    let length = element::take(rest, order)?.numbers(order)?.first().copied().unwrap_or(0.0) as usize;
    let names = element::take(rest, order)?;
    if length == 0 || names.bytes.is_empty() {
        return Ok(Node::Other);
    }
    let name = |bytes: &[u8]| {
        let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
        String::from_utf8_lossy(&bytes[..end]).into_owned()
    };
    let names: Vec<String> = names.bytes.chunks(length).map(name).collect();
    let mut elements = Vec::new();
    for _ in 0..count {
        let nodes = arrays(rest, order, depth, budget, names.len())?;
        elements.push(names.iter().cloned().zip(nodes).collect());
    }
    Ok(Node::Structures(elements))
}

fn numbers(rest: &mut &[u8], order: Order, dimensions: &[usize], count: usize, name: &str) -> Result<Node, Flaw> {
    let data = element::take(rest, order)?.numbers(order)?;
    if data.len() != count {
        return Err(format!("gives `{name}` {count} values by its dimensions but holds {}", data.len()));
    }
    let rows = dimensions.first().copied().unwrap_or(0);
    Ok(Node::Numbers(Values { rows, columns: count.checked_div(rows).unwrap_or(0), data }))
}
