use proc_macro2::TokenStream;
use quote::quote;
use syn::{Error, Expr, ExprLit, ExprUnary, Lit, Result, UnOp};

/// A literal as a composite would write it.
pub(crate) enum Literal {
    /// A number: its digits, with a sign.
    Number(String),
    /// `true` or `false`.
    Bool(bool),
    /// Text.
    Text(String),
}

impl Literal {
    /// Takes the literal of an expression: a number with or without a minus, a bool, a string.
    pub(crate) fn of(expression: &Expr) -> Result<Literal> {
        match expression {
            Expr::Lit(ExprLit { lit, .. }) => match lit {
                Lit::Int(number) => Ok(Literal::Number(number.base10_digits().to_owned())),
                Lit::Float(number) => Ok(Literal::Number(json_number(number.base10_digits()))),
                Lit::Bool(value) => Ok(Literal::Bool(value.value)),
                Lit::Str(text) => Ok(Literal::Text(text.value())),
                _ => Err(expected(expression)),
            },
            Expr::Unary(ExprUnary { op: UnOp::Neg(_), expr, .. }) => match Literal::of(expr)? {
                Literal::Number(digits) => Ok(Literal::Number(format!("-{digits}"))),
                _ => Err(expected(expression)),
            },
            Expr::Group(group) => Literal::of(&group.expr),
            _ => Err(expected(expression)),
        }
    }

    /// The text in the composite.
    pub(crate) fn text(&self) -> String {
        match self {
            Literal::Number(text) | Literal::Text(text) => text.clone(),
            Literal::Bool(value) => value.to_string(),
        }
    }
}

/// The number that a text is, which a constant function cannot read where it has a fraction: an `Option<f64>`.
pub(crate) fn number(text: &str) -> TokenStream {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => quote!(::core::option::Option::Some(#number)),
        _ => quote!(::core::option::Option::None),
    }
}

/// Rust writes `5.`, JSON `5.0`.
fn json_number(digits: &str) -> String {
    match digits.strip_suffix('.') {
        Some(whole) => format!("{whole}.0"),
        None => digits.to_owned(),
    }
}

fn expected(expression: &Expr) -> Error {
    Error::new_spanned(expression, "expected a literal: a number, a string, `true` or `false`")
}
