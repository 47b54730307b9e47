//! The number of replicas of a component, and the table of what differs among them.

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use super::expression_scope::Names;
use super::replica::Instance;
use crate::check::fleet::is_like;
use crate::check::report::{Parts, Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Edit, Severity, codes, nearest, quoted};
use crate::expression::{
    self, Expression, ExpressionError, ExpressionFault, ExpressionValue, INDEX, boolean, integer, parse, pattern,
    render,
};
use crate::model::{ComponentElement, Property, Replicas, Table};
use crate::source::Text;
use crate::syntax::{Document, escaped};

/// Replicas of a fleet in all: a slip of the finger must not take all memory.
pub(crate) const MOST_REPLICAS: u64 = 100_000;

/// Bytes that a replica may be written with and count as one; longer ones count as several.
const BYTES: u64 = 2560;

/// The replicas of a component that are still to be made.
pub(crate) struct Plan<'a> {
    pub(crate) component: &'a ComponentElement,
    pub(crate) names: Rc<Names>,
    next: i64,
    /// The number of there are in all, and still to come.
    pub(crate) count: u64,
    /// As how many they count.
    pub(crate) cost: u64,
    left: u64,
    /// By index, the line of the table.
    rows: HashMap<i64, usize>,
}

impl<'a> Plan<'a> {
    /// The plan of the replicas of a component; `None` with a fault, which is reported. `left` is how many there may
    /// be.
    pub(crate) fn of(
        component: &'a ComponentElement,
        replicas: &'a Replicas,
        document: &Document,
        names: &Rc<Names>,
        (left, lowers_attributes): (u64, bool),
        report: &mut Report<'_>,
    ) -> Option<Self> {
        let Some(written) = &replicas.count else {
            if is_count_misread(component, document, lowers_attributes, report) {
                return None;
            }
            let (what, at) = match (&replicas.from, &replicas.overrides) {
                (Some(from), _) => ("`from` is about".to_owned(), from.location),
                (_, Some(overrides)) => ("`overrides` is about".to_owned(), overrides.location),
                _ => (format!("{} is a name of", quoted(&component.name)), component.name.location),
            };
            let message = format!("{what} replicas, and nothing says how many there are");
            let one = Diagnostic::new(&codes::REPLICAS, at, message);
            report.push(one.help("add `saoms:count=\"...\"`"));
            return None;
        };
        let is_readable = replicas.overrides.is_none() || replicas.table.is_some();
        if let (Some(file), false) = (&replicas.overrides, is_readable || report.has_errors()) {
            // As a rule it was reported by who tried to read it.
            report.push(Diagnostic::new(&codes::FILE_UNREADABLE, file.location, "the file was not read"));
        }
        let count = number(written, names, report);
        let from = replicas.from.as_ref().map_or(Some(1), |from| number(from, names, report));
        let is_named = has_index(component, names, report);
        let (count, from) = (count?, from?);
        let fault = |message: String, help: &str, report: &mut Report<'_>| {
            let mut one = Diagnostic::new(&codes::REPLICAS, written.location, message).help(help);
            for (name, _) in parse(written).ok().iter().flat_map(Expression::names) {
                if let Some(at) = names.place(name) {
                    one = one.label(at, format!("{} is this", quoted(name)));
                }
            }
            report.push(one);
        };
        let Ok(count) = u64::try_from(count) else {
            fault(format!("there cannot be {count} replicas"), "the number of replicas is 0 or more", report);
            return None;
        };
        if count > left {
            let message = match left {
                MOST_REPLICAS => format!("{count} replicas are more than a fleet can have"),
                _ => format!("with {count} replicas here there are more than a fleet can have"),
            };
            fault(message, &format!("a fleet has at most {MOST_REPLICAS} replicas"), report);
            return None;
        }
        let span = component.origin.element(document).span();
        let cost = count.saturating_mul(1 + u64::from(span.end - span.start) / BYTES);
        if cost > left {
            let message = format!("{count} replicas are more than a fleet can have of one that is so long");
            let help = format!(
                "a replica of more than {BYTES} bytes counts as several, and a fleet has at most {MOST_REPLICAS}: put long values into a property that all take as `source`"
            );
            fault(message, &help, report);
            return None;
        }
        if from.checked_add_unsigned(count).is_none() {
            fault("the indices go beyond 64 bits".to_owned(), "choose a smaller `saoms:from`", report);
            return None;
        }
        let names = Rc::clone(names);
        let mut plan = Self { component, names, next: from, count, cost, left: count, rows: HashMap::new() };
        // With faults in its lines all others count.
        replicas.table.iter().for_each(|table| plan.rows(table, report));
        (is_readable && is_named).then_some(plan)
    }

    /// The next replica: its index.
    pub(crate) fn next(&mut self) -> Option<i64> {
        self.left = self.left.checked_sub(1)?;
        self.next += 1;
        Some(self.next - 1)
    }

    /// True if the replica that came last is the first one.
    pub(crate) fn is_at_first(&self) -> bool {
        self.left + 1 == self.count
    }

    /// The first replica, whether there is one or not: what can be known about the others is known by it.
    pub(crate) fn sample(&self) -> i64 {
        self.next
    }

    /// The instance of an index.
    pub(crate) fn instance(&self, index: i64) -> Instance {
        Instance { index, names: Rc::clone(&self.names), partial: None }
    }

    /// The row of the table for an index.
    pub(crate) fn row(&self, index: i64) -> Option<(&'a Table, usize)> {
        let table = self.component.replicas()?.table.as_ref()?;
        Some((table, *self.rows.get(&index)?))
    }

    /// Finds the line of each replica. What is wrong with the lines is reported.
    fn rows(&mut self, table: &Table, report: &mut Report<'_>) {
        if self.count == 0 {
            // As where the number comes from outside: nothing in the table is about anybody now.
            return;
        }
        let last = self.next.saturating_add(self.count as i64 - 1);
        let by_name = (table.key == *"name").then(|| self.by_name());
        if let Some(other) = self.other_key(table, by_name.as_ref()) {
            let message =
                format!("the first column is {}, and its values are of {}", quoted(&table.key), quoted(other));
            let one = Diagnostic::new(&codes::OVERRIDES, table.key.location, message);
            report.push(one.suggest(replacing(&table.key, other), table.key.location, other));
            return;
        }
        let free = OnceCell::new();
        let mut seen: HashMap<i64, &Text> = HashMap::new();
        for (place, row) in table.rows.iter().enumerate() {
            let found = match &by_name {
                Some(by_name) => by_name.get(row.key.as_str()).copied(),
                None => row.key.parse().ok().filter(|index| (self.next..=last).contains(index)),
            };
            let Some(index) = found else {
                let is_possible = match by_name {
                    Some(_) => self.is_possible(&row.key),
                    None => row.key.parse::<i64>().is_ok(),
                };
                let message = format!("there is no replica {}", quoted(&row.key));
                let one = match &by_name {
                    Some(_) if is_possible => Diagnostic::new(&codes::OVERRIDES, row.key.location, message)
                        .help("there would be one if `saoms:count` were larger"),
                    Some(by_name) => {
                        let names = free.get_or_init(|| without_line(by_name, table));
                        let known = ("the table says nothing of", names.iter().copied());
                        let one = report.unknown(&codes::OVERRIDES, row.key.location, message, &row.key, known);
                        match one.suggestions.is_empty() {
                            true => one.help(format!("they are called {}", quoted(&self.component.name))),
                            false => one,
                        }
                    }
                    None => Diagnostic::new(&codes::OVERRIDES, row.key.location, message)
                        .help(format!("the indices go from {} to {last}", self.next)),
                };
                // Fewer robots than the table knows are no mistake where the number is set from outside.
                let severity = if is_possible { Severity::Warning } else { Severity::Error };
                report.line_of_none(one.severity(severity));
                continue;
            };
            report.line(row.key.location);
            if let Some(first) = seen.get(&index) {
                let message = format!("there are two lines about the replica {}", quoted(&row.key));
                let one = Diagnostic::new(&codes::OVERRIDES, row.key.location, message);
                report.push(one.label(first.location, "the first").help("make one of them"));
                continue;
            }
            seen.insert(index, &row.key);
            self.rows.insert(index, place);
        }
    }

    /// The right name of the first column, where its values show that it is wrong.
    fn other_key(&self, table: &Table, by_name: Option<&HashMap<String, i64>>) -> Option<&'static str> {
        let mut keys = table.rows.iter().map(|row| row.key.as_str()).peekable();
        keys.peek()?;
        match by_name {
            Some(names) => {
                let is_index = |key: &str| !names.contains_key(key) && key.parse::<i64>().is_ok();
                keys.all(is_index).then_some("index")
            }
            None => {
                // As a rule the first says that they are numbers.
                if keys.peek().is_some_and(|key| key.parse::<i64>().is_ok()) {
                    return None;
                }
                let names = self.by_name();
                keys.all(|key| names.contains_key(key)).then_some("name")
            }
        }
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
        let indices = (self.next..).take(self.count as usize);
        let named = indices.filter_map(|index| {
            let instance = self.instance(index);
            Some((render(&self.component.name, &mut |name| instance.value(name)).ok()?, index))
        });
        named.collect()
    }
}

/// The names of which a table says nothing, in order.
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

/// True if a component has an attribute that `count` may be meant by, and that is told as an error, which nobody can
/// lower: with it nothing is known of the replicas.
fn is_count_misread(
    component: &ComponentElement,
    document: &Document,
    lowers_attributes: bool,
    report: &mut Report<'_>,
) -> bool {
    let file = document.file();
    let mut attributes = component.origin.element(document).attributes();
    let meant = attributes.find(|attribute| nearest(attribute.local_name(), ["count"]).is_some());
    let Some(meant) = meant else { return false };
    // Of an empty one the whole is told.
    let at = [meant.name_span().in_file(file), meant.location()];
    let is_error = |one: &Diagnostic| at.contains(&one.location) && one.severity == Severity::Error;
    if !lowers_attributes && report.diagnostics().iter().any(is_error) {
        return true;
    }
    // Its namespace may be nearly that of SAOMS.
    let is_near = report.has_diagnostic_about(&codes::NAMESPACE_NEAR, file, meant.namespace());
    if is_near {
        let why =
            format!("{} in it says how many replicas there are, and they cannot be made without", quoted(meant.name()));
        report.diagnostics().escalate(&codes::NAMESPACE_NEAR, file, &why);
    }
    is_near
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
    let message = format!("all replicas would be called {}", quoted(name));
    let meant = with_index(name);
    let one = Diagnostic::new(&codes::REPLICAS, name.location, message);
    // What is written in the same way elsewhere, as in an ID, is meant in the same way.
    let texts = component.properties.iter().flat_map(Property::simple_values);
    let places = std::iter::once(name).chain(texts.filter(|text| text.value == name.value));
    let edits = places.map(|text| Edit { location: text.location, replacement: escaped(&meant) });
    report.push(one.suggest_edits(replacing(name, &meant), edits.collect()));
    false
}

/// A text of replicas that lacks their index, with it: in place of what looks like it, or else at the end.
pub(crate) fn with_index(text: &str) -> String {
    as_index(text).unwrap_or_else(|| format!("{text}${{index}}"))
}

/// A text with the index in place of what looks like it.
pub(crate) fn as_index(text: &str) -> Option<String> {
    /// Other spellings of it.
    const WRITTEN: [(&str, &str); 6] = [
        ("#{index", "${index"),
        ("$(index)", "${index}"),
        ("%index%", "${index}"),
        ("$index", "${index}"),
        ("{index", "${index"),
        ("[index]", "${index}"),
    ];
    let found = WRITTEN.iter().find(|(written, _)| text.contains(written));
    found.map(|(written, meant)| text.replace(written, meant))
}

/// The number that an attribute comes to. Faults are reported.
fn number(text: &Text, names: &Names, report: &mut Report<'_>) -> Option<i64> {
    let value = parse(text).and_then(|one| integer(&one, &mut |name| names.value(name)));
    value.map_err(|fault| report_fault(text, &report.parts(text), &fault, names, report)).ok()
}

/// True if a condition is true. Faults are reported.
pub(crate) fn condition(
    text: &Text,
    names: &Names,
    value: &mut dyn FnMut(&str) -> Result<ExpressionValue, ExpressionError>,
    report: &mut Report<'_>,
) -> Option<bool> {
    let holds = parse(text).and_then(|one| boolean(&one, value));
    holds.map_err(|fault| report_fault(text, &report.parts(text), &fault, names, report)).ok()
}

/// Reports what is wrong with an expression in a text.
pub(crate) fn report_fault(
    text: &Text,
    parts: &Parts,
    fault: &ExpressionFault,
    names: &Names,
    report: &mut Report<'_>,
) {
    let written = text.get(fault.at.clone()).unwrap_or_default();
    if !names.report_value(written.trim(), report) {
        report.push(wrong(text, parts, fault, names));
    }
}

/// The diagnostic about an expression in a text.
fn wrong(text: &Text, parts: &Parts, fault: &ExpressionFault, names: &Names) -> Diagnostic {
    let code: &'static Code = &codes::EXPRESSION;
    let at = parts.part(fault.at.clone());
    let ExpressionError { message, help, instead, .. } = &fault.problem;
    let mut one = Diagnostic::new(code, at, message.clone());
    let written = text.get(fault.at.clone()).unwrap_or_default();
    let inside = parse(written).ok();
    for (name, _) in inside.iter().flat_map(Expression::names) {
        if let Some(place) = names.place(name) {
            one = one.label(place, format!("{} is this", quoted(name)));
        }
    }
    if let Some(help) = help {
        one = one.help(help.clone());
    }
    match instead {
        Some(instead) if instead.is_empty() => one.suggest(format!("remove {}", quoted(written)), at, ""),
        Some(instead) => one.suggest(replacing(written, instead.trim()), at, escaped(instead)),
        None if help.is_none() => one.help("`docs/fleets.md` says what expressions are"),
        None => one,
    }
}
