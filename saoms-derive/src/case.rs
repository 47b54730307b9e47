use syn::Ident;
use syn::ext::IdentExt;

/// `charge_position` and `ChargePosition` become `chargePosition`; `r#move` becomes `move`.
pub(crate) fn lower_camel(ident: &Ident) -> String {
    let mut words = words(ident).into_iter();
    let mut name = words.next().unwrap_or_default();
    for word in words {
        let mut letters = word.chars();
        name.extend(letters.next().into_iter().flat_map(char::to_uppercase));
        name.push_str(letters.as_str());
    }
    name
}

/// `TakeOff` becomes `TAKE_OFF`.
pub(crate) fn screaming_snake(ident: &Ident) -> String {
    words(ident).join("_").to_uppercase()
}

/// The words of a name in lower case. A capital starts a word unless the letter before it is a capital, too.
fn words(ident: &Ident) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before_was_capital = false;
    for letter in ident.unraw().to_string().chars() {
        let capital = letter.is_uppercase();
        if letter == '_' || (capital && !before_was_capital) {
            words.push(String::new());
        }
        if letter != '_'
            && let Some(word) = words.last_mut()
        {
            word.extend(letter.to_lowercase());
        }
        before_was_capital = capital;
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use proc_macro2::Span;

    use super::*;

    #[test]
    fn names_change_their_case() {
        let cases = [
            ("charge_position", "chargePosition", "CHARGE_POSITION"),
            ("ChargePosition", "chargePosition", "CHARGE_POSITION"),
            ("LANDING", "landing", "LANDING"),
            ("x1", "x1", "X1"),
            ("Skip", "skip", "SKIP"),
            ("_hidden", "hidden", "HIDDEN"),
        ];
        for (name, camel, snake) in cases {
            let ident = Ident::new(name, Span::call_site());
            assert_eq!((lower_camel(&ident).as_str(), screaming_snake(&ident).as_str()), (camel, snake));
        }
        assert_eq!(lower_camel(&Ident::new_raw("move", Span::call_site())), "move");
    }
}
