//! What is found in components that are written as one before them is what is found where no two are written alike.

use std::fmt::Write as _;

use proptest::prelude::*;

use crate::support::{nested, outcome, part, shown};

/// Pieces of a fleet; `@` are values, and `~` is what makes each of them one of its own, or does not.
const PIECES: [&str; 7] = [
    "<component name=\"@\">~<implementation.java class=\"example.Robot001\"/><property name=\"ID\" value=\"@\"/><property name=\"period\" value=\"@\"/><property name=\"number\" value=\"@\"/><property name=\"speed\" value=\"@\"/><reference name=\"gps\" target=\"@\"/></component>\n",
    "<component name=\"@\">~<implementation.rust class=\"example.Robot\"/><property name=\"speed\">@</property><property name=\"ID\">@</property><property name=\"period\">@</property></component>\n",
    "<component name=\"@\">~<implementation.rust class=\"example.Gps\"/><service name=\"position\"/></component>\n",
    "<component name=\"@\">~<implementation.rust class=\"@\"/><property name=\"@\" value=\"@\"/></component>\n",
    "<component name=\"@\">~<implementation.java class=\"example.Clock\"/><property name=\"@\" value=\"@\"/><property name=\"@\" value=\"@\"/></component>\n",
    "<component name=\"@\">~<implementation.rust class=\"example.Robot\"/><property name=\"ID\" value=\"@\"/><property name=\"ID\" value=\"@\"/></component>\n",
    "<component name=\"@\">~<implementation.java class=\"example.Clock\"/><property name=\"period\" value=\" @ \"/><property name=\"topicRename\" value=\"@\"/></component>\n",
];

const VALUES: [&str; 22] = [
    "R",
    "1",
    "1",
    "7",
    "99",
    "100",
    "07",
    "0.5",
    "1.25",
    "2.5",
    "10ms",
    "10ms",
    "x",
    "",
    "G",
    "ID",
    "period",
    "example.Robot",
    "example.Clock",
    "a&amp;b",
    "10&#109;s",
    "POSTOPIC,p",
];

/// What is written in components, each of the same length: the same in all, a comment of its own in each, or an instruction, with which no two
/// are written alike.
const FILLERS: [fn(usize) -> String; 3] =
    [|_| " ".repeat(11), |place| format!("<!--{place:04}-->"), |place| format!("<?f {place:05}?>")];

/// The pieces, each with its values in turn; of the first value of each, its name, most are of one component alone.
fn fleet(pieces: &[(usize, Vec<usize>)], filler: fn(usize) -> String) -> String {
    let mut inside = String::new();
    for (place, (piece, values)) in pieces.iter().enumerate() {
        let mut values = values.iter().cycle();
        let mut is_name = true;
        for letter in PIECES[*piece].chars() {
            match letter {
                '@' if std::mem::take(&mut is_name) && place % 9 != 8 => _ = write!(inside, "C{place}"),
                '@' => inside.push_str(values.next().map_or("", |value| VALUES[*value])),
                '~' => inside.push_str(&filler(place)),
                letter => inside.push(letter),
            }
        }
    }
    part("fleet", "", &inside)
}

/// What comes of it, with the classes of tests, and where they are taken as given.
fn found(text: &str) -> (String, String) {
    let (_, diagnostics, sources) = nested(&[text], &[], true);
    (outcome(&[text], &[]), diagnostics.iter().map(|one| shown(one, &sources)).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn a_component_like_one_before_is_checked_as_any_other(
        pieces in prop::collection::vec((0..PIECES.len(), prop::collection::vec(0..VALUES.len(), 1..6)), 1..40),
    ) {
        let [like, commented, unlike] = FILLERS.map(|filler| fleet(&pieces, filler));
        let expected = found(&unlike);
        let differs = |one: &str, other: &str| one.lines().zip(other.lines()).find(|(one, other)| one != other).map(|(one, other)| format!("{one}\n{other}"));
        for text in [like, commented] {
            let found = found(&text);
            let first = differs(&found.0, &expected.0).or_else(|| differs(&found.1, &expected.1));
            prop_assert!(found == expected, "{text}\n{first:?}");
        }
    }
}

#[test]
fn a_sound_fleet_of_components_that_are_written_alike_comes_to_the_same() {
    let fleet = |filler: fn(usize) -> String| {
        let mut inside =
            String::from(r#"<component name="G"><implementation.java class="example.Gps"/></component>"#);
        for number in 1..40 {
            let (filler, speed) = (filler(number as usize), f64::from(number % 3) / 2.0);
            let _ = writeln!(
                inside,
                "<component name=\"C{number}\">{filler}<implementation.rust class=\"example.Robot\"/><property name=\"period\" value=\"10ms\"/><property name=\"number\" value=\"{number}\"/><property name=\"speed\" value=\"{speed}\"/><property name=\"ID\">R{number}</property><reference name=\"gps\" target=\"G\"/></component>"
            );
        }
        outcome(&[&part("fleet", "", &inside)], &[])
    };
    let [like, commented, unlike] = FILLERS.map(fleet);
    let second = "C2 (example.Robot) ID=Text(\"R2\") number=Text(\"2\") speed=Text(\"1\") gps->G/position\n";
    assert!(like.contains(second), "{like}");
    assert_eq!((&like, &commented), (&unlike, &unlike));
}
