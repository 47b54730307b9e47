//! The functions of XPath 1.0 (4), but for `id` and `lang`, which ask for what values of properties do not have.

use std::collections::HashMap;

use super::evaluate::{At, Scope};
use super::value::{Node, Value, number};
use crate::diagnostic::quoted;

/// Bytes of a text that is made of others.
const MOST_JOINED: usize = 1 << 20;

/// A function.
pub(super) struct Function {
    pub(super) name: &'static str,
    /// How many arguments it takes at least, and at most.
    least: usize,
    most: usize,
    pub(super) run: Run,
}

type Run = for<'v, 's, 'a> fn(&Scope<'v, 'a>, &At<'a>, &'s [Value<'a>]) -> Result<Value<'a>, String>;

impl std::fmt::Debug for Function {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl Function {
    pub(super) fn takes(&self, count: usize) -> bool {
        (self.least..=self.most).contains(&count)
    }

    /// How many arguments it takes, in words.
    pub(super) fn arguments(&self) -> String {
        let counted =
            |count| if count == 1 { "one argument".to_owned() } else { format!("{count} arguments") };
        match (self.least, self.most) {
            (0, 0) => "no arguments".to_owned(),
            (least, usize::MAX) => format!("at least {}", counted(least)),
            (least, most) if least == most => counted(least),
            (least, most) => format!("{least} to {}", counted(most)),
        }
    }
}

const fn function(name: &'static str, (least, most): (usize, usize), run: Run) -> Function {
    Function { name, least, most, run }
}

/// Every function.
pub(super) static ALL: [Function; 25] = [
    function("last", (0, 0), |_, at, _| Ok(Value::Number(at.size as f64))),
    function("position", (0, 0), |_, at, _| Ok(Value::Number(at.position as f64))),
    function("count", (1, 1), |_, _, all| Ok(Value::Number(nodes("count", &all[0])?.len() as f64))),
    function("sum", (1, 1), |scope, _, all| {
        Ok(Value::Number(nodes("sum", &all[0])?.iter().map(|node| number(&scope.text(node))).sum()))
    }),
    function("local-name", (0, 1), |_, at, all| {
        Ok(Value::Text(named("local-name", at, all)?.local_name().to_owned()))
    }),
    function("name", (0, 1), |_, at, all| Ok(Value::Text(named("name", at, all)?.name().to_owned()))),
    function("namespace-uri", (0, 1), |_, at, all| {
        Ok(Value::Text(named("namespace-uri", at, all)?.namespace().to_owned()))
    }),
    function("string", (0, 1), |scope, at, all| Ok(Value::Text(text(scope, at, all)))),
    function("concat", (2, usize::MAX), |scope, _, all| {
        let mut joined = String::new();
        for one in all {
            joined.push_str(&one.text(scope));
            if joined.len() > MOST_JOINED {
                return Err(format!(
                    "this makes a text of more than {MOST_JOINED} bytes: one that is so long can stand in a `file`"
                ));
            }
        }
        Ok(Value::Text(joined))
    }),
    function("starts-with", (2, 2), |scope, _, all| {
        Ok(Value::Boolean(all[0].text(scope).starts_with(&all[1].text(scope))))
    }),
    function("contains", (2, 2), |scope, _, all| {
        Ok(Value::Boolean(all[0].text(scope).contains(&all[1].text(scope))))
    }),
    function("substring-before", (2, 2), |scope, _, all| {
        let (whole, part) = (all[0].text(scope), all[1].text(scope));
        Ok(Value::Text(whole.split_once(&*part).map_or_else(String::new, |(before, _)| before.to_owned())))
    }),
    function("substring-after", (2, 2), |scope, _, all| {
        let (whole, part) = (all[0].text(scope), all[1].text(scope));
        Ok(Value::Text(whole.split_once(&*part).map_or_else(String::new, |(_, behind)| behind.to_owned())))
    }),
    function("substring", (2, 3), |scope, _, all| {
        let start = round(all[1].number(scope));
        let end = all.get(2).map_or(f64::INFINITY, |length| start + round(length.number(scope)));
        let is_inside = |place: f64| place >= start && place < end;
        let whole = all[0].text(scope);
        let letters = whole.chars().zip(1u32..).filter(|(_, place)| is_inside(f64::from(*place)));
        Ok(Value::Text(letters.map(|(letter, _)| letter).collect()))
    }),
    function("string-length", (0, 1), |scope, at, all| {
        Ok(Value::Number(text(scope, at, all).chars().count() as f64))
    }),
    function("normalize-space", (0, 1), |scope, at, all| {
        Ok(Value::Text(text(scope, at, all).split_ascii_whitespace().collect::<Vec<_>>().join(" ")))
    }),
    function("translate", (3, 3), |scope, _, all| {
        let (from, to) = (all[1].text(scope), all[2].text(scope));
        let (mut to, mut others) = (to.chars(), HashMap::new());
        for one in from.chars() {
            let other = to.next();
            // Of a letter that is there twice the first counts.
            others.entry(one).or_insert(other);
        }
        let letter = |one: char| others.get(&one).copied().unwrap_or(Some(one));
        Ok(Value::Text(all[0].text(scope).chars().filter_map(letter).collect()))
    }),
    function("boolean", (1, 1), |_, _, all| Ok(Value::Boolean(all[0].boolean()))),
    function("not", (1, 1), |_, _, all| Ok(Value::Boolean(!all[0].boolean()))),
    function("true", (0, 0), |_, _, _| Ok(Value::Boolean(true))),
    function("false", (0, 0), |_, _, _| Ok(Value::Boolean(false))),
    function("number", (0, 1), |scope, at, all| {
        Ok(Value::Number(all.first().map_or_else(|| number(&text(scope, at, all)), |one| one.number(scope))))
    }),
    function("floor", (1, 1), |scope, _, all| Ok(Value::Number(all[0].number(scope).floor()))),
    function("ceiling", (1, 1), |scope, _, all| Ok(Value::Number(all[0].number(scope).ceil()))),
    function("round", (1, 1), |scope, _, all| Ok(Value::Number(round(all[0].number(scope))))),
];

/// To the nearest whole number, a half upwards.
fn round(number: f64) -> f64 {
    (number + 0.5).floor()
}

fn nodes<'v, 'a>(name: &str, value: &'v Value<'a>) -> Result<&'v [Node<'a>], String> {
    match value {
        Value::Nodes(nodes) => Ok(nodes),
        _ => Err(format!("{} takes parts of a property, and not a simple value", quoted(name))),
    }
}

/// The text of the argument, or else of the node at hand.
fn text<'a>(scope: &Scope<'_, 'a>, at: &At<'a>, all: &[Value<'a>]) -> String {
    match all.first() {
        Some(one) => one.text(scope),
        None => at.node.map_or_else(String::new, |node| scope.text(&node)),
    }
}

/// What has a name.
enum Named<'a> {
    Element(crate::xml::Element<'a>),
    Attribute(crate::xml::Attribute<'a>),
    Nothing,
}

impl<'a> Named<'a> {
    fn local_name(&self) -> &'a str {
        match self {
            Self::Element(one) => one.local_name(),
            Self::Attribute(one) => one.local_name(),
            Self::Nothing => "",
        }
    }

    fn name(&self) -> &'a str {
        match self {
            Self::Element(one) => one.name(),
            Self::Attribute(one) => one.name(),
            Self::Nothing => "",
        }
    }

    fn namespace(&self) -> &'a str {
        match self {
            Self::Element(one) => one.namespace(),
            Self::Attribute(one) => one.namespace(),
            Self::Nothing => "",
        }
    }
}

/// The first of the argument, or else the node at hand.
fn named<'a>(name: &str, at: &At<'a>, all: &[Value<'a>]) -> Result<Named<'a>, String> {
    let node = match all.first() {
        Some(one) => nodes(name, one)?.first().copied(),
        None => at.node,
    };
    Ok(match node {
        Some(Node::Element(one, _)) => Named::Element(one),
        Some(Node::Attribute(one, ..)) => Named::Attribute(one),
        _ => Named::Nothing,
    })
}
