//! Paths into the values of properties.

use super::*;

const BAYS: &str = "<property name=\"b\"><bays unit=\"m\"><bay id=\"a\"><x>3</x></bay><p:bay xmlns:p=\"urn:p\" id=\"b\" p:w=\"2\"><y/></p:bay></bays></property>
<property name=\"many\" many=\"true\"><value><x>1</x></value><value><y>2</y></value></property>
<property name=\"places\" element=\"p:place\"><p:place><z/></p:place><p:place><z/></p:place></property>";

fn at(source: &str) -> Vec<String> {
    proposed(&composite(&format!("{BAYS}{ROBOT}<property name=\"ID\" source=\"{source}\"/></component>")))
}

#[test]
fn behind_a_slash_stand_the_parts_of_the_value() {
    assert_eq!(at("$b/|"), ["bay", "bays", "@unit"]);
    assert_eq!(at("$b/bays/|"), ["bay", "@unit"]);
    assert_eq!(at("$b/bay/|"), ["x", "y", "@id", "@w"]);
    assert_eq!(at("$b/bays/bay[2]/|"), ["x", "y", "@id", "@w"]);
    assert_eq!(at("$b/bay[@id='a']/@|"), ["x", "y", "@id", "@w"]);
    assert_eq!(at("$b//|"), ["bay", "bays", "x", "y", "@id", "@unit", "@w"]);
    assert_eq!(at("$b/bay/x/../../|"), ["bay", "@unit"]);
    assert_eq!(at("$b/nothing/|"), [""; 0]);
    assert_eq!(at("$nothing/|"), [""; 0]);
    assert_eq!(at("$many/|"), ["x", "y"]);
    assert_eq!(at("$many[1]/|"), ["x", "y"]);
    assert_eq!(at("$places/|"), ["z"]);
}

#[test]
fn paths_complete_inside_of_expressions_too() {
    assert_eq!(at("$b/bay[|"), ["x", "y", "@id", "@w"]);
    assert_eq!(at("$b/bay[@id='a' and x/|]"), [""; 0]);
    assert_eq!(at("$b/bays[bay/|]"), ["x", "y", "@id", "@w"]);
    assert_eq!(at("concat($b/bay[1]/x, $many/|)"), ["x", "y"]);
    assert_eq!(at("concat('x', |)"), ["$b", "$many", "$places"]);
    assert_eq!(at("$b/bay[x=$m|"), ["$b", "$many", "$places"]);
    let source = |inside: &str| format!("{BAYS}{ROBOT}<property name=\"ID\" source=\"{inside}\"/></component>");
    let all = |inside: &str, label: &str| taken(&composite(&source(inside)), label, false);
    assert_eq!(all("concat($b/bay/i|d, 'x')", "@id"), composite(&source("concat($b/bay/@id, 'x')")));
    assert_eq!(all("$b/ba|x/y", "bay"), composite(&source("$b/bay/y")));
    assert_eq!(all("concat('x', $|)", "$many"), composite(&source("concat('x', $many)")));
}

#[test]
fn what_parts_are_compared_with_is_what_they_are() {
    assert_eq!(at("$b/bay[@id='|"), ["a", "b"]);
    assert_eq!(at("$b/bay[@id = '|']/x"), ["a", "b"]);
    assert_eq!(at("$b/bay[@id!='|']/x"), ["a", "b"]);
    assert_eq!(at("$b/bay[x='|']"), ["3"]);
    assert_eq!(at("$b/bays[bay/@id='|']"), ["a", "b"]);
    assert_eq!(at("$b/bays/bay/x[. = '|']"), ["3"]);
    assert_eq!(at("$b/bays/@unit = '|'"), ["m"]);
    assert_eq!(at("concat('|')"), [""; 0]);
    assert_eq!(at("$b/bay[@none='|']"), [""; 0]);
    assert_eq!(at("$b/bay[contains(@id, '|')]"), [""; 0]);
    let source = |inside: &str| format!("{BAYS}{ROBOT}<property name=\"ID\" source=\"{inside}\"/></component>");
    let all = |inside: &str, label: &str| taken(&composite(&source(inside)), label, false);
    assert_eq!(all("$b/bay[@id='|a-z']/x", "b"), composite(&source("$b/bay[@id='b']/x")));
}

#[test]
fn a_component_gives_the_composite_that_implements_it_its_values() {
    let user = composite(
        "<component name=\"H\"><implementation.composite name=\"fleet\"/><property name=\"b\"><c><d/></c></property></component>",
    );
    let user = user.replace("name=\"fleet\" targetNamespace", "name=\"user\" targetNamespace");
    let inside = format!("<property name=\"b\"/>{ROBOT}<property name=\"ID\" source=\"$b/c/|\"/></component>");
    assert_eq!(proposed_among(&composite(&inside), &[("user.composite", &user)]), ["d"]);
}
