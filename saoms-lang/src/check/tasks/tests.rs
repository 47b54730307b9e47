//! Texts of task properties, without composites.

use proptest::prelude::*;

use super::broker_address;
use crate::assembly::topic_rename;

proptest! {
    #[test]
    fn renames_are_read_from_any_text(text in "([ABab ,:é]|::|, ){0,12}") {
        let (pairs, faults) = topic_rename::parse(&text);
        for pair in &pairs {
            for name in [&pair.old, &pair.new] {
                prop_assert_eq!(&text[name.at.clone()], name.text);
                prop_assert!(!name.text.is_empty() && name.text == name.text.trim());
            }
        }
        for fault in &faults {
            prop_assert!(text.get(fault.at.clone()).is_some());
        }
        if faults.is_empty() {
            let written: Vec<String> = pairs.iter().map(|pair| format!("{},{}", pair.old.text, pair.new.text)).collect();
            let again = written.join("::");
            let (same, none) = topic_rename::parse(&again);
            prop_assert!(none.is_empty());
            let names = |pairs: &[topic_rename::Pair<'_>]| -> Vec<(String, String)> {
                pairs.iter().map(|pair| (pair.old.text.to_owned(), pair.new.text.to_owned())).collect()
            };
            prop_assert_eq!(names(&same), names(&pairs));
        }
    }

    #[test]
    fn any_text_is_an_address_or_has_a_fault_inside_it(text in "[a1:.\\[\\]é/ -]{0,12}") {
        match broker_address::fault(&text) {
            Some(fault) => prop_assert!(text.get(fault.at).is_some(), "{}", text),
            None => prop_assert!(text.rsplit_once(':').is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok())),
        }
    }
}
