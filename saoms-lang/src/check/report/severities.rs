//! Severities that composites and the command line set.

use std::collections::HashMap;

use crate::check::options::Options;
use crate::diagnostic::{
    Code, Diagnostic, Diagnostics, Label, SetBy, Severity, SeverityLevel, codes, nearest, nearest_code, quoted,
};
use crate::model::Contribution;
use crate::registry::Registry;
use crate::source::{FileId, Located, Location, Sources, Span, Text};

/// A severity that is set on the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct SeveritySetting {
    /// The code.
    pub code: Text,
    /// Its level.
    pub level: Located<SeverityLevel>,
    /// The reason.
    pub reason: Option<Text>,
}

impl SeveritySetting {
    /// Reads `CODE=LEVEL` or `CODE=LEVEL:REASON`, the value of the option `option` (as `--severity`). It becomes a
    /// source text of that name, so that diagnostics can point into it. `None`, and a diagnostic, when it is none.
    pub fn parse(option: &str, text: &str, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Self> {
        let file = sources.add(option, text);
        let split = text.find('=').unwrap_or(text.len());
        let (code, level) = (&text[..split], &text[(split + 1).min(text.len())..]);
        let with_reason = level.split_once(':').filter(|(_, reason)| !reason.trim().is_empty());
        let (level, reason) = with_reason.unwrap_or((level, &text[text.len()..]));
        let [code, level, reason] = [code, level, reason].map(|part| Text::part_of(file, text, part));
        if let Some(found) = SeverityLevel::from_name(&level) {
            let level = Located::new(found, level.location);
            return Some(Self { code, level, reason: Some(reason).filter(|reason| !reason.is_empty()) });
        }
        let names = SeverityLevel::ALL.map(SeverityLevel::name);
        let one = if level.is_empty() {
            let whole = Span::new(0, text.len() as u32).in_file(file);
            Diagnostic::new(&codes::SEVERITY, whole, format!("{} sets no severity", quoted(text)))
        } else {
            let message = format!("there is no severity {}", quoted(&level));
            let one = Diagnostic::new(&codes::SEVERITY, level.location, message);
            let word = match level.to_ascii_lowercase().as_str() {
                "off" | "none" | "ignore" | "disable" | "silent" => Some("allow"),
                "info" | "hint" => Some("note"),
                "warn" => Some("warning"),
                "fatal" | "deny" | "forbid" => Some("error"),
                _ => None,
            };
            match word.or_else(|| nearest(&level, names)) {
                None if SeverityLevel::from_name(&code).is_some() => {
                    let (whole, meant) = (Span::new(0, text.len() as u32).in_file(file), format!("{level}={code}"));
                    one.suggest(format!("write {}: the code comes first", quoted(&meant)), whole, meant)
                }
                Some(meant) => one.suggest(format!("replace it with {}", quoted(meant)), level.location, meant),
                None => one,
            }
        };
        let help = format!(
            "write `{option} CODE=LEVEL` or `{option} 'CODE=LEVEL:REASON'`, with `allow`, `note`, `warning` or `error`"
        );
        diagnostics.push(one.help(help));
        None
    }
}

/// All that is said about severities, what counts first before the others.
pub(crate) struct Severities {
    rules: Vec<Rule>,
    /// The codes of rules over fleets whose errors keep a fleet from starting.
    preventing: Vec<&'static str>,
}

struct Rule {
    code: String,
    set: SetBy,
    scope: Scope,
    is_used: bool,
    /// True if it is wrong, which is reported: nothing but errors of its code is reported beside that.
    is_wrong: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Scope {
    /// This element.
    Element(Location),
    /// The composite in this file.
    File(FileId),
    /// The whole fleet.
    Fleet,
    /// The same, from the command line.
    Option,
}

impl Scope {
    /// The size of a scope: a smaller one counts before a larger one.
    fn size(self) -> (u8, u32) {
        match self {
            Self::Element(at) => (0, at.span.len()),
            Self::File(_) => (1, 0),
            Self::Fleet => (2, 0),
            Self::Option => (3, 0),
        }
    }

    fn holds(self, at: Location) -> bool {
        match self {
            Self::Element(element) => element.file == at.file && element.span.contains(at.span),
            Self::File(file) => file == at.file,
            Self::Fleet | Self::Option => true,
        }
    }
}

impl Severities {
    /// The severities that composites and options set. Unknown codes are reported.
    pub(crate) fn of<'o>(
        contribution: &'o Contribution,
        options: &'o Options,
        registry: &Registry,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let known: Vec<&Code> =
            codes::ALL.iter().copied().chain(registry.rules().iter().map(|rule| rule.code())).collect();
        let mut rules: Vec<Rule> = Vec::new();
        // The rules of each place about each code.
        let mut said: HashMap<(&str, Scope), Vec<usize>> = HashMap::new();
        let mut add = |code: &'o Text, level: SeverityLevel, reason: Option<&Text>, scope: Scope, is_wrong: bool| {
            let is_known = known.iter().any(|known| known.id == code.as_str());
            if !is_known {
                diagnostics.push(unknown(code, &known));
            }
            if is_wrong || !is_known {
                if let Some(meant) = meant(code, &known) {
                    let set = SetBy { level: SeverityLevel::Allow, at: code.location, is_option: false, reason: None };
                    let code = meant.to_owned();
                    rules.push(Rule { code, set, scope, is_used: true, is_wrong: true });
                }
                return;
            }
            let reason = reason.map(|reason| reason.as_str().to_owned());
            let is_option = matches!(scope, Scope::Option);
            let set = SetBy { level, at: code.location, is_option, reason };
            let known = said.entry((code, scope)).or_default();
            let said_before = known.iter().map(|place| &rules[*place]).find(|known: &&Rule| {
                // Files that are one fleet together may say the same.
                known.set.at.file == code.location.file || is_option || known.set.level != level
            });
            if let Some(known) = said_before {
                diagnostics.push(twice(code, level, &known.set));
                return;
            }
            known.push(rules.len());
            rules.push(Rule { code: code.as_str().to_owned(), set, scope, is_used: false, is_wrong: false });
        };
        let asked_for = contribution.asked_for().len();
        for (place, composite) in contribution.composites().iter().enumerate() {
            for rule in &composite.severities {
                let scope = match rule.within {
                    Some(element) => Scope::Element(element),
                    None if place < asked_for => Scope::Fleet,
                    None => Scope::File(composite.file()),
                };
                add(&rule.code, rule.level.value, Some(&rule.reason), scope, rule.is_wrong);
            }
        }
        for setting in &options.severities {
            add(&setting.code, setting.level.value, setting.reason.as_ref(), Scope::Option, false);
        }
        rules.sort_by_key(|rule| rule.scope.size());
        let preventing = registry.rules().iter().filter(|rule| rule.prevents_start());
        let preventing = preventing.map(|rule| rule.code().id).collect();
        Self { rules, preventing }
    }

    /// True if files have faults of syntax or structure that no severity lets pass.
    pub(crate) fn is_misread(&self, diagnostics: &Diagnostics) -> bool {
        diagnostics.iter().any(|one| one.code.id.starts_with("S10") && !self.mentions(one.code))
    }

    /// True if anything is said about a code.
    pub(crate) fn mentions(&self, code: &Code) -> bool {
        self.rules.iter().any(|rule| rule.code == code.id && !rule.is_wrong)
    }

    /// Sets the severities of the diagnostics from this place on.
    pub(crate) fn apply(&mut self, from: usize, diagnostics: &mut Diagnostics) {
        if self.rules.is_empty() {
            return;
        }
        diagnostics.adjust(from, |one| {
            let holds = |rule: &Rule, at: Location| rule.code == one.code.id && rule.scope.holds(at);
            let is_element = |rule: &Rule| matches!(rule.scope, Scope::Element(_));
            let own = self.rules.iter().position(|rule| holds(rule, one.location));
            // What is wrong between two elements is found in the second of them, and is about the first as well.
            let of_other = || {
                let is_about = |rule: &Rule| one.labels.iter().any(|label| holds(rule, label.location));
                self.rules.iter().position(|rule| is_element(rule) && is_about(rule))
            };
            let Some(place) = own.filter(|own| is_element(&self.rules[*own])).or_else(of_other).or(own) else { return };
            let rule = &mut self.rules[place];
            if rule.is_wrong && one.severity == Severity::Error {
                return;
            }
            rule.is_used = true;
            let is_lowered = rule.set.level != SeverityLevel::Set(Severity::Error);
            let is_fixed = !codes::is_judgement(one.code) || self.preventing.contains(&one.code.id);
            if one.severity == Severity::Error && is_lowered && is_fixed {
                let label = format!("not set to `{}`", rule.set.level.name());
                one.labels.push(Label { location: rule.set.at, text: label });
                one.help.push("its severity cannot be lowered: no fleet can run with this error".to_owned());
                return;
            }
            if let SeverityLevel::Set(severity) = rule.set.level {
                one.severity = severity;
                if let Some(reason) = &rule.set.reason {
                    let text = format!("set to `{}`: {reason}", severity.name());
                    one.labels.push(Label { location: rule.set.at, text });
                }
            }
            one.set = Some(rule.set.clone());
        });
    }

    /// Reports what composites say that changed nothing, without the codes that were not looked for.
    pub(crate) fn finish(&self, wiring: bool, diagnostics: &mut Diagnostics) {
        let in_files = self.rules.iter().filter(|rule| !matches!(rule.scope, Scope::Option));
        let unused = in_files.filter(|rule| !rule.is_used && rule.set.level != SeverityLevel::Set(Severity::Error));
        for rule in unused.filter(|rule| wiring || !codes::is_of_wiring(&rule.code)) {
            let message =
                format!("setting {0} to `{1}` has no effect: there is no {0} here", rule.code, rule.set.level.name());
            let one = Diagnostic::new(&codes::SEVERITY_UNUSED, rule.set.at, message);
            diagnostics.push(one.help("remove it: it would hide a later fault"));
        }
    }

    /// Reports options that change nothing, because composites set what there is to something else: what has a reason
    /// there stays.
    pub(crate) fn overruled(&self, diagnostics: &mut Diagnostics) {
        let options = self.rules.iter().filter(|rule| matches!(rule.scope, Scope::Option) && !rule.is_used);
        for option in options {
            let is_other =
                |rule: &&Rule| rule.code == option.code && rule.is_used && rule.set.level != option.set.level;
            let Some(by) = self.rules.iter().find(is_other) else { continue };
            let (code, asked, level) = (&option.code, option.set.level.name(), by.set.level.name());
            let message =
                format!("{code} is not set to `{asked}`: a composite sets it to `{level}`, which takes precedence");
            let one = Diagnostic::new(&codes::SEVERITY_UNUSED, option.set.at, message);
            // One for all fleets is stricter than what one of them gives a reason for.
            let is_stricter = option.set.level.hides() < by.set.level.hides();
            let one = if is_stricter { one.severity(Severity::Note) } else { one };
            diagnostics.push(one.label(by.set.at, "set here").help("change it there, or leave the option out"));
        }
    }
}

fn twice(code: &Text, level: SeverityLevel, first: &SetBy) -> Diagnostic {
    let (one, other) = (level.name(), first.level.name());
    let message = match one == other {
        true => format!("the severity of {code} is set twice"),
        false => format!("the severity of {code} is set to `{other}` and to `{one}`"),
    };
    Diagnostic::new(&codes::SEVERITY, code.location, message).label(first.at, "first set here").help("keep one of them")
}

fn unknown(code: &Text, known: &[&'static Code]) -> Diagnostic {
    let one = Diagnostic::new(&codes::SEVERITY, code.location, format!("there is no code {}", quoted(code)));
    match meant(code, known) {
        Some(meant) => one.replace(code, code.location, meant),
        None => one.help("each diagnostic shows its code, and `saoms explain` lists them"),
    }
}

/// The code that is meant by one, or by what a code is called.
fn meant(code: &Text, known: &[&'static Code]) -> Option<&'static str> {
    let by_name = known.iter().find(|known| known.name == code.as_str()).map(|known| known.id);
    by_name.or_else(|| nearest_code(code, &known.iter().map(|known| known.id).collect::<Vec<_>>()))
}
