use syn::{Error, Expr, RangeLimits, Result};

use crate::literal::Literal;

/// The bounds of `range = ...`, as text.
#[derive(Default)]
pub(crate) struct Range {
    pub(crate) min: Option<String>,
    pub(crate) max: Option<String>,
    pub(crate) exclusive_max: Option<String>,
    /// The bounds as they stand.
    pub(crate) bounds: Vec<Expr>,
}

impl Range {
    pub(crate) fn of(expression: &Expr) -> Result<Range> {
        let Expr::Range(range) = expression else {
            return Err(Error::new_spanned(
                expression,
                "expected a range, as in `0..=10`, `0.0..1.0` or `\"1ms\"..=\"1h\"`",
            ));
        };
        let bound =
            |end: &Option<Box<Expr>>| end.as_deref().map(|end| Literal::of(end).map(|end| end.text())).transpose();
        let (min, end) = (bound(&range.start)?, bound(&range.end)?);
        if let (Some(Ok(start)), Some(Ok(end))) =
            (min.as_ref().map(|text| text.parse::<f64>()), end.as_ref().map(|text| text.parse::<f64>()))
            && (start > end || (start == end && matches!(range.limits, RangeLimits::HalfOpen(_))))
        {
            return Err(Error::new_spanned(expression, "this range holds no value"));
        }
        let bounds = [&range.start, &range.end].into_iter().flatten().map(|bound| (**bound).clone()).collect();
        Ok(match range.limits {
            RangeLimits::Closed(_) => Range { min, max: end, exclusive_max: None, bounds },
            RangeLimits::HalfOpen(_) => Range { min, max: None, exclusive_max: end, bounds },
        })
    }

    /// True if a number is within the range, or if the text is no number.
    pub(crate) fn holds(&self, number: &str) -> bool {
        let Ok(number) = number.parse::<f64>() else { return true };
        let bound = |bound: &Option<String>| bound.as_ref().and_then(|text| text.parse::<f64>().ok());
        bound(&self.min).is_none_or(|min| number >= min)
            && bound(&self.max).is_none_or(|max| number <= max)
            && bound(&self.exclusive_max).is_none_or(|max| number < max)
    }
}
