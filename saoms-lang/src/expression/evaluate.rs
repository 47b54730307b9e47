//! Evaluation of expressions.

use smol_str::{SmolStr, format_smolstr};

use super::parse::Node;
use super::{Expression, ExpressionError, ExpressionFault, ExpressionValue, Lookup};
use crate::diagnostic::{meant_boolean, quoted};

/// The whole number that an expression comes to.
///
/// # Errors
/// A name has no value, or it comes to something else.
pub fn integer(expression: &Expression, lookup: &mut Lookup<'_>) -> Result<i64, ExpressionFault> {
    number(value(expression, lookup)?, expression)
}

/// The text that stands for an expression in a text: its number with at least so many digits, or the text of a name
/// that stands alone.
///
/// # Errors
/// A name has no value, or it comes to something else.
pub(super) fn text(
    expression: &Expression,
    digits: usize,
    lookup: &mut Lookup<'_>,
) -> Result<SmolStr, ExpressionFault> {
    match value(expression, lookup)? {
        ExpressionValue::Text(text) if digits == 0 && matches!(expression.node, Node::Name(..)) => Ok(text),
        value => Ok(format_smolstr!("{:0digits$}", number(value, expression)?)),
    }
}

/// True if an expression is true.
///
/// # Errors
/// A name has no value, or it comes to something else.
pub fn boolean(expression: &Expression, lookup: &mut Lookup<'_>) -> Result<bool, ExpressionFault> {
    condition(value(expression, lookup)?, expression)
}

fn number(value: ExpressionValue, of: &Expression) -> Result<i64, ExpressionFault> {
    match value {
        ExpressionValue::Integer(number) => Ok(number),
        other => Err(ExpressionError::new(format!("found {other}, expected a whole number")).at(of.at.clone())),
    }
}

fn condition(value: ExpressionValue, of: &Expression) -> Result<bool, ExpressionFault> {
    match value {
        ExpressionValue::Boolean(value) => Ok(value),
        other => {
            let help = match &other {
                ExpressionValue::Text(text) if meant_boolean(text).is_some() => {
                    let meant = meant_boolean(text).unwrap_or_default();
                    format!("give it the value `{meant}`: a condition is `true` or `false`, or compares something")
                }
                ExpressionValue::Integer(number @ (0 | 1)) => format!(
                    "give it the value `{}`: a condition is `true` or `false`, or compares something, as in `robots > 10`",
                    *number == 1
                ),
                _ => "compare it with something, as in `robots > 10`".to_owned(),
            };
            Err(ExpressionError::new(format!("found {other}, expected a condition")).help(help).at(of.at.clone()))
        }
    }
}

/// Chains such as `1 + 2 + 3` lean to the left: they are followed in a loop, so that only parentheses and signs cost
/// the stack a frame.
fn value(expression: &Expression, lookup: &mut Lookup<'_>) -> Result<ExpressionValue, ExpressionFault> {
    let mut chain = Vec::new();
    let mut first = expression;
    while let Node::Two(left, operator, right) = &first.node {
        chain.push((first, *operator, &**right));
        first = left;
    }
    let mut left = (single(first, lookup)?, first);
    for (whole, operator, right) in chain.into_iter().rev() {
        left = (two(whole, left, operator, right, lookup)?, whole);
    }
    Ok(left.0)
}

fn single(expression: &Expression, lookup: &mut Lookup<'_>) -> Result<ExpressionValue, ExpressionFault> {
    match &expression.node {
        Node::Value(value) => Ok(value.clone()),
        Node::Name(name, at) => lookup(name).map_err(|problem| problem.at(at.clone())),
        Node::Not(inner) => Ok(ExpressionValue::Boolean(!boolean(inner, lookup)?)),
        Node::Negative(inner) => {
            let number = integer(inner, lookup)?;
            number.checked_neg().map(ExpressionValue::Integer).ok_or_else(|| overflow(expression))
        }
        Node::Two(..) => value(expression, lookup),
    }
}

/// Applies an operator to the value on its left, given with its expression, and to the expression on its right.
fn two(
    whole: &Expression,
    (left, of): (ExpressionValue, &Expression),
    operator: &str,
    right: &Expression,
    lookup: &mut Lookup<'_>,
) -> Result<ExpressionValue, ExpressionFault> {
    match operator {
        "and" | "or" => {
            let decides = operator == "or";
            let left = condition(left, of)?;
            // The right side is looked at in any case: what is wrong with it is wrong. But the left one may keep
            // numbers from it.
            match boolean(right, lookup) {
                Err(fault) if left == decides && fault.problem.is_arithmetic => Ok(ExpressionValue::Boolean(left)),
                right => Ok(ExpressionValue::Boolean(if decides { left | right? } else { left & right? })),
            }
        }
        "==" | "!=" => {
            let other = value(right, lookup).map_err(|fault| unquoted(fault, &left, right))?;
            if std::mem::discriminant(&left) != std::mem::discriminant(&other) {
                let message = format!("{left} cannot be compared with {other}");
                return Err(ExpressionError::new(message)
                    .help("write texts between two `'`; numbers, `true` and `false` have no quotes")
                    .at(whole.at.clone()));
            }
            Ok(ExpressionValue::Boolean((left == other) == (operator == "==")))
        }
        _ => {
            let (one, other) = (number(left, of)?, integer(right, lookup)?);
            calculated(whole, one, operator, other, right)
        }
    }
}

/// A fault of what a text is compared with: an unknown name is probably a text without its quotes.
fn unquoted(fault: ExpressionFault, text: &ExpressionValue, of: &Expression) -> ExpressionFault {
    let (ExpressionValue::Text(_), Node::Name(name, _), None) = (text, &of.node, &fault.problem.instead) else {
        return fault;
    };
    let also = fault.problem.help.as_ref().map_or(String::new(), |help| format!("; {help}"));
    let help = format!("write a text between two `'`, as {}{also}", quoted(&format!("'{name}'")));
    ExpressionFault { problem: fault.problem.help(help), ..fault }
}

fn calculated(
    whole: &Expression,
    one: i64,
    operator: &str,
    other: i64,
    right: &Expression,
) -> Result<ExpressionValue, ExpressionFault> {
    let number = match operator {
        "<" => return Ok(ExpressionValue::Boolean(one < other)),
        "<=" => return Ok(ExpressionValue::Boolean(one <= other)),
        ">" => return Ok(ExpressionValue::Boolean(one > other)),
        ">=" => return Ok(ExpressionValue::Boolean(one >= other)),
        "/" | "%" if other == 0 => {
            let message = match right.node {
                Node::Value(_) => "division by zero".to_owned(),
                _ => format!("division by zero: {} is 0", quoted(&right.divisor)),
            };
            let problem = ExpressionError { is_arithmetic: true, ..ExpressionError::new(message) };
            return Err(problem.at(right.at.clone()));
        }
        "+" => one.checked_add(other),
        "-" => one.checked_sub(other),
        "*" => one.checked_mul(other),
        "/" => floored(one, other),
        _ => one.checked_rem_euclid(other),
    };
    number.map(ExpressionValue::Integer).ok_or_else(|| overflow(whole))
}

/// A quotient rounded down, whatever the signs are.
fn floored(one: i64, other: i64) -> Option<i64> {
    let quotient = one.checked_div(other)?;
    let is_between = one % other != 0 && (one < 0) != (other < 0);
    Some(if is_between { quotient - 1 } else { quotient })
}

fn overflow(expression: &Expression) -> ExpressionFault {
    let problem = ExpressionError::new("the number is too large: beyond 64 bits");
    ExpressionError { is_arithmetic: true, ..problem }.at(expression.at.clone())
}
