//! Places of findings of constructors about parts of values.

use expect_test::expect;

use crate::check::support::{faults, faults_of, fleet};

fn reader(inside: &str) -> String {
    format!("<component name=\"R\"><implementation.java class=\"example.Reader\"/>\n{inside}\n</component>")
}

#[test]
fn each_is_shown_at_the_very_characters() {
    let inside = "<property name=\"words\">
  one bad line
  <!-- no bad --> <![CDATA[ a bed ]]> &#98;ig &lt;big b&amp;
  \u{fc}b\u{fc}ng b\u{e4}d
</property>";
    expect![[r#"
        4:7-10 error S3014: component `R`: property `words`: cannot read `bad`
          help: `saoms components example.Reader` describes its properties
        5:31-34 error S3014: component `R`: property `words`: cannot read `bed`
          4:7-10 the first
          help: `saoms components example.Reader` describes its properties
        5:39-46 error S3014: component `R`: property `words`: cannot read `big`
          4:7-10 the first
          help: `saoms components example.Reader` describes its properties
        5:55-61 error S3014: component `R`: property `words`: cannot read `b&`
          4:7-10 the first
          help: begin at the begin
          fix: replace `b&` with `a&` [5:55-61 "a&amp;"]
        6:9-12 error S3014: component `R`: property `words`: cannot read `bäd`
          4:7-10 the first
          help: `saoms components example.Reader` describes its properties
    "#]]
    .assert_eq(&faults(&reader(inside)));
    let crlf = fleet(&reader("<property name=\"words\">\r\none\r\n bad</property>"));
    expect![[r#"
        5:2-5 error S3014: component `R`: property `words`: cannot read `bad`
          help: `saoms components example.Reader` describes its properties
    "#]]
    .assert_eq(&faults_of(&[&crlf], &[]));
}

#[test]
fn each_of_several_values_has_its_own_place() {
    let inside = "<property name=\"words\"><value>good</value>
<value>a bad</value>
<value>&#32;bed &#32;</value></property>
<property name=\"title\" value=\"a\tbad &quot;b&amp;&#10;bat\"/>";
    expect![[r#"
        4:10-13 error S3014: component `R`: property `words`: cannot read `bad`
          help: `saoms components example.Reader` describes its properties
        5:13-16 error S3014: component `R`: property `words`: cannot read `bed`
          4:10-13 the first
          help: `saoms components example.Reader` describes its properties
        6:33-36 error S3014: component `R`: property `title`: cannot read `bad`
          4:10-13 the first
          help: `saoms components example.Reader` describes its properties
        6:54-57 error S3014: component `R`: property `title`: cannot read `bat`
          4:10-13 the first
          help: `saoms components example.Reader` describes its properties
    "#]]
    .assert_eq(&faults(&reader(inside)));
}

#[test]
fn values_from_elsewhere_are_shown_there() {
    let inside = format!(
        "<property name=\"book\" many=\"true\"><value>a bad</value><value>b&amp;</value></property>{}",
        reader("<property name=\"words\" source=\"$book\"/>")
    );
    expect![[r#"
        2:44-47 error S3014: component `R`: property `words`: cannot read `bad`
          3:32-37 used here as `words`
          help: `saoms components example.Reader` describes its properties
        2:62-68 error S3014: component `R`: property `words`: cannot read `b&`
          2:44-47 the first
          3:32-37 used here as `words`
          help: begin at the begin
          fix: replace `b&` with `a&` [2:62-68 "a&amp;"]
    "#]]
    .assert_eq(&faults(&inside));
    expect![[r#"
        --set:1:11-13 error S3014: component `R`: property `words`: cannot read `b&`
          3:32-37 used here as `words`
          help: begin at the begin
          fix: replace `b&` with `a&` [--set:1:11-13 "a&"]
    "#]]
    .assert_eq(&faults_of(&[&fleet(&inside)], &["book=good b&"]));
}
