//! What expressions come to.

use super::parse::Node;
use super::{Expression, Fault, Lookup, Problem, Value};
use crate::diagnostic::quoted;

/// The whole number that an expression comes to.
///
/// # Errors
/// A name has no value, or it comes to something else.
pub fn integer(expression: &Expression, lookup: &mut Lookup<'_>) -> Result<i64, Fault> {
    match value(expression, lookup)? {
        Value::Integer(number) => Ok(number),
        other => Err(Problem::new(format!("here is {other}, and a whole number is expected"))
            .at(expression.at.clone())),
    }
}

/// Whether an expression is true.
///
/// # Errors
/// A name has no value, or it comes to something else.
pub fn boolean(expression: &Expression, lookup: &mut Lookup<'_>) -> Result<bool, Fault> {
    match value(expression, lookup)? {
        Value::Boolean(value) => Ok(value),
        other => Err(Problem::new(format!("here is {other}, and a condition is expected"))
            .help("compare it with something, as in `robots > 10`")
            .at(expression.at.clone())),
    }
}

fn value(expression: &Expression, lookup: &mut Lookup<'_>) -> Result<Value, Fault> {
    match &expression.node {
        Node::Value(value) => Ok(value.clone()),
        Node::Name(name) => lookup(name).map_err(|problem| problem.at(expression.at.clone())),
        Node::Not(inner) => Ok(Value::Boolean(!boolean(inner, lookup)?)),
        Node::Negative(inner) => {
            let number = integer(inner, lookup)?;
            number.checked_neg().map(Value::Integer).ok_or_else(|| overflow(expression))
        }
        Node::Two(left, operator @ ("and" | "or"), right) => {
            let decides = *operator == "or";
            let left = boolean(left, lookup)?;
            // The right side is looked at in any case: what is wrong with it is wrong. But the left one may keep numbers from it.
            match boolean(right, lookup) {
                Err(fault) if left == decides && fault.problem.is_arithmetic => Ok(Value::Boolean(left)),
                right => Ok(Value::Boolean(if decides { left | right? } else { left & right? })),
            }
        }
        Node::Two(left, operator @ ("==" | "!="), right) => {
            let (one, other) = (value(left, lookup)?, value(right, lookup)?);
            if std::mem::discriminant(&one) != std::mem::discriminant(&other) {
                let message = format!("{one} cannot be compared with {other}");
                return Err(Problem::new(message)
                    .help("texts stand between two `'`, numbers and `true` and `false` do not")
                    .at(expression.at.clone()));
            }
            Ok(Value::Boolean((one == other) == (*operator == "==")))
        }
        Node::Two(left, operator, right) => {
            let (one, other) = (integer(left, lookup)?, integer(right, lookup)?);
            let number = match *operator {
                "<" => return Ok(Value::Boolean(one < other)),
                "<=" => return Ok(Value::Boolean(one <= other)),
                ">" => return Ok(Value::Boolean(one > other)),
                ">=" => return Ok(Value::Boolean(one >= other)),
                "/" | "%" if other == 0 => {
                    let message = format!("{} is divided by zero", quoted(&one.to_string()));
                    let problem = Problem { is_arithmetic: true, ..Problem::new(message) };
                    return Err(problem.at(right.at.clone()));
                }
                "+" => one.checked_add(other),
                "-" => one.checked_sub(other),
                "*" => one.checked_mul(other),
                "/" => one.checked_div_euclid(other),
                _ => one.checked_rem_euclid(other),
            };
            number.map(Value::Integer).ok_or_else(|| overflow(expression))
        }
    }
}

fn overflow(expression: &Expression) -> Fault {
    let problem = Problem::new("the number is too large: beyond 64 bits");
    Problem { is_arithmetic: true, ..problem }.at(expression.at.clone())
}
