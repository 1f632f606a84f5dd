//! The one file that speaks to the expression library, `exmex`: text in, our tree out.
//!
//! `exmex` evaluates an expression on any type with any operators. Its type here is the tree itself and its operators build
//! nodes, so that one evaluation is the parse: precedence, parentheses, calls and names are the library's, while units,
//! derivatives and what a state means stay ours ([ADR 19](../../../../../docs/adr/0019-own-effects.md)).

use super::expression::{Function, Operation, Tree};
use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator};
use std::str::FromStr;

/// The functions that an expression may call.
pub(super) const FUNCTIONS: [&str; 13] =
    ["abs", "sign", "sqrt", "exp", "ln", "sin", "cos", "tanh", "max", "min", "lag", "play", "relay"];

impl FromStr for Tree {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.parse().map(Tree::Number).map_err(|_| format!("`{text}` is not a number"))
    }
}

#[derive(Debug, Clone)]
struct Operators;

fn binary(
    sign: &'static str,
    prio: i64,
    is_commutative: bool,
    apply: fn(Tree, Tree) -> Tree,
) -> Operator<'static, Tree> {
    Operator::make_bin(sign, BinOp { apply, prio, is_commutative })
}

impl MakeOperators<Tree> for Operators {
    fn make<'a>() -> Vec<Operator<'a, Tree>> {
        use Function::{Abs, Cos, Exp, Ln, Sign, Sin, Sqrt, Tanh};
        use Operation::{Add, Divide, Lag, Max, Min, Multiply, Play, Power, Relay, Subtract};
        vec![
            binary("+", 0, false, |a, b| Tree::pair(Add, a, b)),
            binary("-", 1, false, |a, b| Tree::pair(Subtract, a, b)),
            binary("*", 2, false, |a, b| Tree::pair(Multiply, a, b)),
            binary("/", 3, false, |a, b| Tree::pair(Divide, a, b)),
            binary("^", 4, false, |a, b| Tree::pair(Power, a, b)),
            binary("max", 5, false, |a, b| Tree::pair(Max, a, b)),
            binary("min", 5, false, |a, b| Tree::pair(Min, a, b)),
            binary("lag", 5, false, |a, b| Tree::pair(Lag, a, b)),
            binary("play", 5, false, |a, b| Tree::pair(Play, a, b)),
            binary("relay", 5, false, |a, b| Tree::pair(Relay, a, b)),
            Operator::make_unary("abs", |a| Tree::call(Abs, a)),
            Operator::make_unary("sign", |a| Tree::call(Sign, a)),
            Operator::make_unary("sqrt", |a| Tree::call(Sqrt, a)),
            Operator::make_unary("exp", |a| Tree::call(Exp, a)),
            Operator::make_unary("ln", |a| Tree::call(Ln, a)),
            Operator::make_unary("sin", |a| Tree::call(Sin, a)),
            Operator::make_unary("cos", |a| Tree::call(Cos, a)),
            Operator::make_unary("tanh", |a| Tree::call(Tanh, a)),
        ]
    }
}

exmex::literal_matcher_from_pattern!(Numbers, r"^([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?");

/// Reads an expression.
pub(super) fn parse(text: &str) -> Result<Tree, String> {
    if let Some(odd) = text.chars().find(|c| !c.is_ascii() || c.is_ascii_control()) {
        return Err(format!("`{odd}` cannot stand in an expression"));
    }
    if text.trim().is_empty() {
        return Err("is empty; write what the effect adds at its place".into());
    }
    check_calls(text)?;
    let spelled = without_signs(text)?;
    let expression = FlatEx::<Tree, Operators, Numbers>::parse(&spelled).map_err(|e| format!("`{text}`: {e}"))?;
    let names: Vec<Tree> = expression.var_names().iter().map(|name| Tree::Name(name.clone())).collect();
    expression.eval(&names).map_err(|e| format!("`{text}`: {e}"))
}

/// The same with a difference from nothing for each sign in front of a term: the library's own sign binds tighter than a power,
/// against the field's habit.
fn without_signs(text: &str) -> Result<String, String> {
    let (mut spelled, mut last) = (String::with_capacity(2 * text.len()), '(');
    for (place, c) in text.char_indices() {
        // The sign of a number's exponent belongs to the number.
        let before = &text[..place];
        let mantissa = before.strip_suffix(['e', 'E']).unwrap_or_default();
        let in_number = mantissa.ends_with(|c: char| c.is_ascii_digit() || c == '.')
            && !mantissa
                .trim_end_matches(|c: char| c.is_ascii_digit() || c == '.')
                .ends_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        if matches!(c, '+' | '-') && !in_number {
            if matches!(last, '(' | ',') {
                spelled.push('0');
            } else if matches!(last, '+' | '-' | '*' | '/' | '^') {
                return Err(format!(
                    "`{text}`: `{last}{c}` can be read in two ways; put what the sign belongs to in parentheses"
                ));
            }
        }
        spelled.push(c);
        if !c.is_whitespace() {
            last = c;
        }
    }
    Ok(spelled)
}

/// Refuses what the library would read in a way that a reader might not: a function without parentheses, and a name that
/// is called but no function.
fn check_calls(text: &str) -> Result<(), String> {
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_alphabetic() || c == '_') {
        // The exponent of a number is no name.
        let number = rest[..start].ends_with(|c: char| c.is_ascii_digit() || c == '.');
        let end =
            rest[start..].find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).map_or(rest.len(), |n| start + n);
        let (name, after) = (&rest[start..end], rest[end..].trim_start());
        let called = after.starts_with('(');
        if !number && called && !FUNCTIONS.contains(&name) {
            return Err(format!("`{name}(` is no function; there are {}", FUNCTIONS.join(", ")));
        }
        if !called && FUNCTIONS.contains(&name) {
            return Err(format!("`{name}` is a function: write {name}(...)"));
        }
        rest = &rest[end..];
    }
    Ok(())
}
