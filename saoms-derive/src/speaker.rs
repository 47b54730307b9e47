//! Fields of messages that say who speaks.

use syn::ext::IdentExt;
use syn::parse::ParseStream;
use syn::{Error, Ident, LitStr, Result, Token, parenthesized};

use crate::json::quoted;

/// `speaker("field", only(stage = "TAKEN"), unless(stage = "REQUEST"), instead = "...")`.
pub(crate) struct Speaker {
    field: LitStr,
    only: Vec<Condition>,
    unless: Vec<Condition>,
    instead: String,
}

/// `stage = "REQUEST"`: a field has this constant.
struct Condition {
    field: LitStr,
    constant: LitStr,
}

impl Speaker {
    pub(crate) fn of(input: ParseStream<'_>) -> Result<Speaker> {
        let list;
        parenthesized!(list in input);
        let (field, only, unless, instead) = (list.parse()?, Vec::new(), Vec::new(), String::new());
        let mut speaker = Speaker { field, only, unless, instead };
        while list.parse::<Option<Token![,]>>()?.is_some() && !list.is_empty() {
            let word: Ident = list.parse()?;
            match word.to_string().as_str() {
                "only" => speaker.only.push(Condition::of(&list)?),
                "unless" => speaker.unless.push(Condition::of(&list)?),
                "instead" => {
                    list.parse::<Token![=]>()?;
                    speaker.instead = list.parse::<LitStr>()?.value();
                }
                _ => return Err(Error::new(word.span(), "expected `only`, `unless` or `instead`")),
            }
        }
        if list.is_empty() { Ok(speaker) } else { Err(list.error("expected the end")) }
    }

    /// All fields that it names.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &LitStr> {
        let conditions = self.only.iter().chain(&self.unless);
        std::iter::once(&self.field).chain(conditions.map(|condition| &condition.field))
    }

    fn json(&self) -> String {
        let mut text = format!("{{\"field\":{}", quoted(&self.field.value()));
        for (member, conditions) in [("only", &self.only), ("unless", &self.unless)] {
            let pair = |one: &Condition| format!("{}:{}", quoted(&one.field.value()), quoted(&one.constant.value()));
            let pairs: Vec<String> = conditions.iter().map(pair).collect();
            if !pairs.is_empty() {
                text.push_str(&format!(",\"{member}\":{{{}}}", pairs.join(",")));
            }
        }
        if !self.instead.is_empty() {
            text.push_str(&format!(",\"instead\":{}", quoted(&self.instead)));
        }
        text + "}"
    }
}

impl Condition {
    fn of(input: ParseStream<'_>) -> Result<Condition> {
        let list;
        parenthesized!(list in input);
        let field = Ident::parse_any(&list)?;
        list.parse::<Token![=]>()?;
        let (field, constant) = (LitStr::new(&field.unraw().to_string(), field.span()), list.parse()?);
        if list.is_empty() { Ok(Condition { field, constant }) } else { Err(list.error("expected the end")) }
    }
}

/// The JSON list of the fields.
pub(crate) fn list(speakers: &[Speaker]) -> String {
    format!("[{}]", speakers.iter().map(Speaker::json).collect::<Vec<_>>().join(","))
}
