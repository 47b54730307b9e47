//! The number of replicas of a component, and the table of what differs among them.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

use crate::check::fleet::is_like;
use crate::check::judged::{Faulty, Judged};
use crate::check::report::{Report, replacing};
use crate::check::values::expression_scope::Names;
use crate::check::values::replica::Instance;
use crate::diagnostic::{Diagnostic, Edit, Severity, codes, quoted};
use crate::expression::{
    self, Expression, ExpressionError, ExpressionFault, ExpressionValue, INDEX, boolean, integer, parse, pattern,
    render,
};
use crate::limits::{REPLICA_BYTES, REPLICAS};
use crate::model::{ComponentElement, MisreadCount, Property, Replicas, Row, Table};
use crate::source::{Location, Text};
use crate::syntax::{Document, escaped};

/// The replicas of a component that are still to be made.
pub(crate) struct Plan<'a> {
    pub(crate) component: &'a ComponentElement,
    pub(crate) names: Rc<Names>,
    /// The index of the first replica, whether there is one or not: what can be known about the others is known by it.
    pub(crate) first: i64,
    /// The indices of those that are still to be made.
    pub(crate) left: Range<i64>,
    /// As how many they count.
    pub(crate) cost: u64,
    table: Option<&'a Table>,
    /// By index, the line of the table.
    rows: HashMap<i64, usize>,
}

impl<'a> Plan<'a> {
    /// The plan of at most `left` replicas of a component.
    pub(crate) fn of(
        component: &'a ComponentElement,
        replicas: &'a Replicas,
        document: &Document,
        names: &Rc<Names>,
        table: Judged<Option<&'a Table>>,
        (left, lowers_attributes): (u64, bool),
        report: &mut Report<'_>,
    ) -> Judged<Self> {
        let Some(written) = &replicas.count else {
            match replicas.misread_count {
                Some(MisreadCount::Namespace) => return Err(Faulty),
                // Where the error may be let pass, it is not enough.
                Some(MisreadCount::Attribute) if !lowers_attributes => return Err(Faulty),
                _ => {}
            }
            let (what, at) = match (&replicas.from, &replicas.overrides) {
                (Some(from), _) => ("`from` is for".to_owned(), from.location),
                (_, Some(overrides)) => ("`overrides` is for".to_owned(), overrides.location),
                _ => (format!("{} is a name for", quoted(&component.name)), component.name.location),
            };
            let message = format!("{what} replicas, but the number of replicas is missing");
            let one = Diagnostic::new(&codes::REPLICAS, at, message);
            report.push(one.help("add `saoms:count=\"...\"` to the component"));
            return Err(Faulty);
        };
        let count = number(written, names, report);
        let from = replicas.from.as_ref().map_or(Ok(1), |from| number(from, names, report));
        let is_named = has_index(component, names, report);
        let (count, from) = (count?, from?);
        let span = component.origin.element(document).span();
        let cost = count.unsigned_abs().saturating_mul(1 + u64::from(span.end - span.start) / REPLICA_BYTES);
        let (message, help) = match from.checked_add(count) {
            _ if count < 0 => (format!("there cannot be {count} replicas"), "write a number of 0 or more".to_owned()),
            _ if count.unsigned_abs() > left => {
                let message = match left {
                    REPLICAS => format!("{count} replicas are more than a fleet can have"),
                    _ => format!("with these {count} replicas, the fleet has too many"),
                };
                (message, format!("use fewer: a fleet has at most {REPLICAS} replicas"))
            }
            _ if cost > left => (
                format!("{count} replicas of this length are more than a fleet can have"),
                format!(
                    "put long values into a property of the composite, and use it as `source`: a replica of more \
                    than {REPLICA_BYTES} bytes counts as several, and a fleet has at most {REPLICAS}"
                ),
            ),
            None => {
                ("the largest index does not fit into 64 bits".to_owned(), "choose a smaller `saoms:from`".to_owned())
            }
            Some(end) => {
                let names = Rc::clone(names);
                let lines = table.ok().flatten();
                let (left, rows) = (from..end, HashMap::new());
                let mut plan = Self { component, names, first: from, left, cost, table: lines, rows };
                // With faults in its lines all others count.
                lines.iter().for_each(|table| plan.rows(table, report));
                return if table.is_ok() && is_named { Ok(plan) } else { Err(Faulty) };
            }
        };
        let one = Diagnostic::new(&codes::REPLICAS, written.location, message).help(help);
        report.push(with_values(one, written, names));
        Err(Faulty)
    }

    /// The instance of an index.
    pub(crate) fn instance(&self, index: i64) -> Instance {
        Instance { index, names: Rc::clone(&self.names), partial: None }
    }

    /// The row of the table for an index.
    pub(crate) fn row(&self, index: i64) -> Option<(&'a Table, usize)> {
        Some((self.table?, *self.rows.get(&index)?))
    }

    /// Finds the line of each replica. What is wrong with the lines is reported.
    fn rows(&mut self, table: &Table, report: &mut Report<'_>) {
        if self.left.is_empty() {
            // As where the number comes from outside: no line of the table is about a replica now.
            return;
        }
        let is_by_name = table.key == *"name";
        let names = self.by_name();
        let is_name = |row: &Row| names.contains_key(row.key.as_str());
        let is_index = |row: &Row| row.key.parse::<i64>().is_ok();
        let other = if is_by_name { "index" } else { "name" };
        let is_other = |row: &Row| is_name(row) != is_by_name && is_index(row) == is_by_name;
        if !table.rows.is_empty() && table.rows.iter().all(is_other) {
            let (key, values) = (quoted(&table.key), quoted(other));
            let message = format!("the first column is called {key}, but it contains values of {values}");
            let one = Diagnostic::new(&codes::OVERRIDES, table.key.location, message);
            return report.push(one.suggest(replacing(&table.key, other), table.key.location, other));
        }
        let free = without_line(&names, table);
        for (place, row) in table.rows.iter().enumerate() {
            let found = match is_by_name {
                true => names.get(row.key.as_str()).copied(),
                false => row.key.parse().ok().filter(|index| self.left.contains(index)),
            };
            let Some(index) = found else {
                let is_possible = if is_by_name { self.is_possible(&row.key) } else { is_index(row) };
                let message = match row.key.is_empty() {
                    true => "this row does not name its replica".to_owned(),
                    false => format!("there is no replica {}", quoted(&row.key)),
                };
                let one = match is_by_name {
                    true if is_possible => Diagnostic::new(&codes::OVERRIDES, row.key.location, message)
                        .help("increase `saoms:count`, or remove the row"),
                    true => {
                        let known = ("replicas without a row are", free.iter().copied());
                        let one = report.unknown(&codes::OVERRIDES, row.key.location, message, &row.key, known);
                        match one.suggestions.is_empty() {
                            true => one.help(format!("the replicas have the names {}", quoted(&self.component.name))),
                            false => one,
                        }
                    }
                    false => {
                        let one = Diagnostic::new(&codes::OVERRIDES, row.key.location, message);
                        match names.get(row.key.as_str()) {
                            Some(index) => one.replace(&row.key, row.key.location, &index.to_string()),
                            None => one.help(format!("use an index from {} to {}", self.first, self.left.end - 1)),
                        }
                    }
                };
                // Fewer robots than the table knows are no mistake where the number is set from outside.
                let severity = if is_possible { Severity::Warning } else { Severity::Error };
                report.line_without_replica(one.severity(severity));
                continue;
            };
            match self.rows.get(&index) {
                None => {
                    self.rows.insert(index, place);
                    match self.component.condition.as_ref().filter(|condition| self.is_left_out(index, condition)) {
                        None => report.line(row.key.location),
                        // A condition with a sign that it cannot have is reported, and may say something else.
                        Some(condition) if report.written(condition.location).contains('<') => {}
                        Some(condition) => report.line_without_replica(left_out(row, condition)),
                    }
                }
                Some(first) => {
                    report.line(row.key.location);
                    let message = format!("two rows are for the replica {}", quoted(&row.key));
                    let one = Diagnostic::new(&codes::OVERRIDES, row.key.location, message);
                    report.push(one.label(table.rows[*first].key.location, "the first").help("merge them"));
                }
            }
        }
    }

    /// True if a condition is false for a replica. Its faults are reported where the replica is made.
    fn is_left_out(&self, index: i64, condition: &Text) -> bool {
        let instance = self.instance(index);
        let holds = parse(condition).and_then(|one| boolean(&one, &mut |name| instance.value(name)));
        matches!(holds, Ok(false))
    }

    /// True if there can be a replica of this name, were there more of them.
    fn is_possible(&self, name: &str) -> bool {
        let pattern = pattern(&self.component.name);
        let Some((before, behind)) = pattern.split_once('*') else { return false };
        let number = |name: &str| {
            let number = name.strip_prefix(before)?.strip_suffix(behind)?;
            number.parse::<i64>().ok()
        };
        if behind.contains('*') {
            return is_like(name, &pattern);
        }
        let Some(index) = number(name) else { return false };
        // Where the number is the index, it is written in one way.
        let instance = self.instance(index);
        let rendered = render(&self.component.name, &mut |name| instance.value(name));
        rendered.is_ok_and(|rendered| rendered == name || number(&rendered) != Some(index))
    }

    /// The index of each name.
    fn by_name(&self) -> HashMap<String, i64> {
        let named = self.left.clone().filter_map(|index| {
            let instance = self.instance(index);
            Some((render(&self.component.name, &mut |name| instance.value(name)).ok()?, index))
        });
        named.collect()
    }
}

/// The warning about a row whose replica is absent because of its condition, which may depend on values from outside.
fn left_out(row: &Row, condition: &Text) -> Diagnostic {
    let message = format!("the condition leaves out the replica {}", quoted(&row.key));
    let one = Diagnostic::new(&codes::OVERRIDES, row.key.location, message).severity(Severity::Warning);
    one.label(condition.location, "false for it").help("change the condition, or remove the row")
}

/// The names without a line in a table, in order.
fn without_line<'n>(names: &'n HashMap<String, i64>, table: &Table) -> Vec<&'n str> {
    let said: HashSet<&str> = table.rows.iter().map(|row| row.key.as_str()).collect();
    let mut names: Vec<&str> = names.keys().map(String::as_str).filter(|name| !said.contains(name)).collect();
    names.sort_unstable();
    names
}

/// The index of the first replica as far as it is known, without a word about faults.
pub(crate) fn first_index(replicas: &Replicas, names: &Names) -> Option<i64> {
    let Some(from) = &replicas.from else { return Some(1) };
    parse(from).and_then(|one| integer(&one, &mut |name| names.value(name))).ok()
}

/// Checks that the name of a replicated component differs from replica to replica.
fn has_index(component: &ComponentElement, names: &Rc<Names>, report: &mut Report<'_>) -> bool {
    let name = &component.name;
    if name.is_empty() || expression::names(name).iter().any(|name| name == INDEX) {
        return !name.is_empty();
    }
    // A wrong expression is reported when it is used.
    let instance = Instance { index: 0, names: Rc::clone(names), partial: None };
    if render(name, &mut |name| instance.value(name)).is_err() {
        return true;
    }
    let message = format!("all replicas would have the name {}", quoted(name));
    let meant = with_index(name);
    let one = Diagnostic::new(&codes::REPLICAS, name.location, message);
    // What is written in the same way elsewhere, as in an ID, is meant in the same way.
    let texts = component.properties.iter().flat_map(Property::simple_values);
    let places = std::iter::once(name).chain(texts.filter(|text| text.value == name.value));
    let edits = places.map(|text| Edit { location: text.location, replacement: escaped(&meant) });
    report.push(one.suggest_edits(replacing(name, &meant), edits.collect()));
    false
}

/// A text of replicas that lacks their index, with it: in place of what looks like it or is the number of the first one
/// (`Robot01`), or else at the end.
pub(crate) fn with_index(text: &str) -> String {
    as_index(text).unwrap_or_else(|| {
        let stem = text.trim_end_matches(|sign: char| sign.is_ascii_digit());
        match text.len() - stem.len() {
            1 if text.ends_with('1') => format!("{stem}${{index}}"),
            digits if digits > 1 && text[stem.len()..].trim_start_matches('0') == "1" => {
                format!("{stem}${{index:0{digits}}}")
            }
            _ => format!("{text}${{index}}"),
        }
    })
}

/// A text with the index in place of what looks like it.
pub(crate) fn as_index(text: &str) -> Option<String> {
    /// Other spellings of it.
    const WRITTEN: [(&str, &str); 10] = [
        ("#{index", "${index"),
        ("$(index)", "${index}"),
        ("%index%", "${index}"),
        ("$index", "${index}"),
        ("{index", "${index"),
        ("[index]", "${index}"),
        ("%d", "${index}"),
        ("%02d", "${index:02}"),
        ("%03d", "${index:03}"),
        ("{}", "${index}"),
    ];
    if text.contains("{{index") {
        return Some(text.replace("{{index", "${index").replace("}}", "}"));
    }
    let found = WRITTEN.iter().find(|(written, _)| text.contains(written));
    found.map(|(written, meant)| text.replace(written, meant))
}

/// The number that an attribute comes to. Faults are reported.
fn number(text: &Text, names: &Names, report: &mut Report<'_>) -> Judged<i64> {
    let value = parse(text).and_then(|one| integer(&one, &mut |name| names.value(name)));
    value.map_err(|fault| report_faults(text, &[fault], names, report))
}

/// True if a condition is true. Faults are reported.
pub(crate) fn condition(
    text: &Text,
    names: &Names,
    value: &mut dyn FnMut(&str) -> Result<ExpressionValue, ExpressionError>,
    report: &mut Report<'_>,
) -> Judged<bool> {
    let holds = parse(text).and_then(|one| boolean(&one, value));
    holds.map_err(|fault| report_faults(text, &[fault], names, report))
}

/// Reports what is wrong with the expressions in a text.
pub(crate) fn report_faults(text: &Text, faults: &[ExpressionFault], names: &Names, report: &mut Report<'_>) -> Faulty {
    let parts = report.parts(text);
    for fault in faults {
        let written = text.get(fault.at.clone()).unwrap_or_default();
        // A fault of the XML, too, which is reported.
        if report.written(parts.part(fault.at.clone())) == "&&" {
            continue;
        }
        if !names.report_value(written.trim(), report) {
            report.push(wrong(written, parts.part(fault.at.clone()), &fault.problem, names));
        }
    }
    Faulty
}

/// A diagnostic with the places of the values that an expression asks for.
fn with_values(one: Diagnostic, written: &str, names: &Names) -> Diagnostic {
    let inside = parse(written).ok();
    let asked = inside.iter().flat_map(Expression::names);
    let known = asked.filter_map(|(name, _)| Some((names.place(name)?, format!("the value of {}", quoted(name)))));
    known.fold(one, |one, (place, what)| one.label(place, what))
}

/// The diagnostic about an expression in a text.
fn wrong(written: &str, at: Location, problem: &ExpressionError, names: &Names) -> Diagnostic {
    let ExpressionError { message, help, instead, .. } = problem;
    let mut one = with_values(Diagnostic::new(&codes::EXPRESSION, at, message.clone()), written, names);
    one.help.extend(help.clone());
    match instead {
        Some(instead) if instead.is_empty() => one.suggest(format!("remove {}", quoted(written)), at, ""),
        Some(instead) => one.suggest(replacing(written, instead.trim()), at, escaped(instead)),
        None if help.is_none() => one.help("`docs/fleets.md` describes expressions"),
        None => one,
    }
}
