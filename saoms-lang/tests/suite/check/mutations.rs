//! Random composites: whatever they are, the checker answers, and points into them.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;
use saoms_lang::source::Location;

use crate::check::support::run;

/// The examples of all diagnostics, and a fleet that uses most of the language.
static TEXTS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/check/examples");
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let texts = paths.iter().filter(|path| path.extension().is_some_and(|kind| kind == "composite"));
    texts.map(|path| fs::read_to_string(path).unwrap()).chain([crate::check::support::fleet(EVERYTHING)]).collect()
});

const EVERYTHING: &str = r#"<property name="pace">250us</property>
<property name="where"><value><at xmlns="urn:x"><x>3</x><y>4</y></at></value></property>
<service name="s" promote="R/move"/>
<reference name="r" promote="G/other"/>
<component name="N" autowire="true"><implementation.rust class="example.Navigator"/><reference name="wheels" target="R/move"/></component>
<component name="R"><implementation.java class="example.Robot001"/>
<property name="ID">R</property><property name="period" source="$pace"/><property name="charger" source="$where/at"/>
<property name="stops"><value>1</value><value>2</value></property>
<property name="topicRename">POSTOPIC,pos::ORDERS,orders</property><property name="url">[::1]:61616</property>
<property name="restart">onFailure</property><property name="deadline">100us</property>
<service name="TaskInterface"><interface.java interface="unibg.robotics.tca.TaskInterface"/><binding.sca name="b"/></service>
<reference name="gps" multiplicity="0..1"/></component>
<component name="G"><implementation.java class="example.Gps"/></component>
<wire source="N/task" target="R/TaskInterface/b"/><wire source="R/gps" target="G" replace="true"/>"#;

/// The replacements of words of a text: words that mean something elsewhere, and some that break forms.
const WORDS: &[&str] = &[
    "", "$", "$pace", "$where/at/x", "/", "R/move", "G/position/b", "::", ",", "POSTOPIC", "-1", "0", "1e99", "é",
    "&lt;", "true", "test", "R", "N", "G/other", "0..n", "1..1", "example.Gps", "example.Fragile", "localhost:0",
    "x:y",
];

fn answers(text: &str) -> Result<(), TestCaseError> {
    let (assembly, diagnostics, sources) = run(&[text], &["pace=1 s"]);
    prop_assert_eq!(assembly.is_none(), diagnostics.iter().any(|one| one.severity.name() == "error"));
    let is_inside = |at: Location| {
        let text = sources.get(at.file).text();
        text.get(at.span.start as usize..at.span.end as usize).is_some()
    };
    for one in &diagnostics {
        prop_assert!(is_inside(one.location), "{:?}", one);
        prop_assert!(one.labels.iter().all(|label| is_inside(label.location)), "{:?}", one);
        let mut edits = one.suggestions.iter().flat_map(|suggestion| &suggestion.edits);
        prop_assert!(edits.all(|edit| is_inside(edit.location)), "{:?}", one);
    }
    Ok(())
}

/// The places of what stands between quotes or tags.
fn words(text: &str) -> Vec<std::ops::Range<usize>> {
    let marks: Vec<usize> = text.match_indices(['"', '<', '>']).map(|(at, _)| at).collect();
    let between = marks.windows(2).map(|pair| pair[0] + 1..pair[1]);
    between.filter(|range| !text[range.clone()].contains('=')).collect()
}

proptest! {
    #[test]
    fn a_word_in_place_of_another(text in any::<prop::sample::Index>(), place in any::<prop::sample::Index>(), word in prop::sample::select(WORDS)) {
        let text = text.get(&TEXTS);
        let range = place.get(&words(text)).clone();
        answers(&format!("{}{word}{}", &text[..range.start], &text[range.end..]))?;
    }

    #[test]
    fn a_line_more_or_twice_or_elsewhere(text in any::<prop::sample::Index>(), from in any::<prop::sample::Index>(), to in any::<prop::sample::Index>()) {
        let lines: Vec<&str> = EVERYTHING.lines().collect();
        let mut target: Vec<&str> = text.get(&TEXTS).lines().collect();
        target.insert(to.index(target.len()), lines[from.index(lines.len())]);
        answers(&target.join("\n"))?;
    }
}

#[test]
fn what_is_mutated_is_right_but_for_a_warning() {
    expect_test::expect![[r#"
        5:18-19 warning S2022: reference `r` of the composite is not wired to a service: calls through it fail
          help: wire the component's reference inside the composite: a composite that runs by itself has nothing around it
    "#]]
    .assert_eq(&crate::check::support::faults(EVERYTHING));
}
