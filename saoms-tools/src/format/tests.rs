use std::sync::Arc;

use expect_test::{Expect, expect};

use super::{WIDTH, format};
use saoms_lang::source::FileId;
use saoms_lang::syntax::parse;

fn formatted(text: &str, width: usize) -> String {
    format(&parse(FileId(0), &Arc::new(text.into())).well_formed().unwrap(), width)
}

fn test(text: &str, expected: Expect) {
    let once = formatted(text, WIDTH);
    expected.assert_eq(&once);
    assert_eq!(formatted(&once, WIDTH), once, "formatted again");
}

/// The content of a composite.
fn composite(content: &str) -> String {
    format!("<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='c'>{content}</composite>")
}

#[test]
fn parts_get_lines_of_their_own_and_text_stays() {
    test(
        &composite(
            "<component name = 'R'   ><implementation.java class='robot.R'></implementation.java>
<property name='ID'> R </property><property name='n'><value>1</value>  <value> 2</value></property
></component >",
        ),
        expect![[r#"
            <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="c">
              <component name="R">
                <implementation.java class="robot.R"/>
                <property name="ID"> R </property>
                <property name="n">
                  <value>1</value>
                  <value> 2</value>
                </property>
              </component>
            </composite>
        "#]],
    );
}

#[test]
fn comments_stay_on_their_line_and_blank_lines_are_kept_once() {
    test(
        "<?xml version='1.0'?>

<!-- what it is -->
<!-- and more --><a>

  <b/>    <!-- beside -->
     <!-- before c,
  in two lines -->
  <?go on?>



  <c><d/></c>

</a><!-- behind -->

<!-- last -->

",
        expect![[r#"
            <?xml version='1.0'?>

            <!-- what it is -->
            <!-- and more -->
            <a>

              <b/> <!-- beside -->
              <!-- before c,
              in two lines -->
              <?go on?>

              <c>
                <d/>
              </c>

            </a> <!-- behind -->

            <!-- last -->
        "#]],
    );
}

#[test]
fn the_last_comment_of_an_element_stands_in_it() {
    test(
        "<a>
<b><c/> <!-- beside c -->
<!-- <d/> -->

<?last of b?> </b>
<e><!-- alone --></e><f>
<!-- only child -->
</f>
<!-- <g/> --></a>
<!-- behind -->",
        expect![[r#"
            <a>
              <b>
                <c/> <!-- beside c -->
                <!-- <d/> -->

                <?last of b?>
              </b>
              <e><!-- alone --></e>
              <f>
            <!-- only child -->
            </f>
              <!-- <g/> -->
            </a>
            <!-- behind -->
        "#]],
    );
}

#[test]
fn white_space_that_means_something_stays() {
    test(
        &composite(
            "<property name='a'>  </property><property name='b'> <![CDATA[ ]]> </property><component name='R'>
 </component><property name='c'><x:p xmlns:x='u'>one <x:b>two</x:b>
 </x:p><x:q xmlns:x='u'> </x:q></property><documentation>see <a/>  <b/></documentation>
<property name='d' xml:space='preserve'> <x:p xmlns:x='u'/> </property><property name='e'>&#32;</property>",
        ),
        expect![[r#"
            <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="c">
              <property name="a">  </property>
              <property name="b"> <![CDATA[ ]]> </property>
              <component name="R"/>
              <property name="c">
                <x:p xmlns:x="u">one <x:b>two</x:b>
             </x:p>
                <x:q xmlns:x="u"> </x:q>
              </property>
              <documentation>see <a/>  <b/></documentation>
              <property name="d" xml:space="preserve"> <x:p xmlns:x='u'/> </property>
              <property name="e">&#32;</property>
            </composite>
        "#]],
    );
}

#[test]
fn attributes_that_do_not_fit_get_a_line_each() {
    let text = "<a><bcd  e='1' xmlns:f=\"2\"  g='\"' h='&quot;'/></a>";
    expect![[r#"
        <a>
          <bcd e="1" xmlns:f="2" g='"' h="&quot;"/>
        </a>
    "#]]
    .assert_eq(&formatted(text, 43));
    expect![[r#"
        <a>
          <bcd e="1"
              xmlns:f="2"
              g='"'
              h="&quot;"/>
        </a>
    "#]]
    .assert_eq(&formatted(text, 42));
}

#[test]
fn lines_end_as_the_first_does() {
    assert_eq!(formatted("\u{feff}<a\r\n>\n<b/>x\r</a>", WIDTH), "\u{feff}<a>\r\n<b/>x\r\n</a>\r\n");
    assert_eq!(formatted("<a>\n<b>x\r\ny\r</b></a>", WIDTH), "<a>\n  <b>x\ny\n</b>\n</a>\n");
}

/// Neither the stack nor, by indentation, the memory grows with the depth.
#[test]
fn depth_costs_nothing() {
    let depth = 20_000;
    let text = format!("{}{}", "<a>".repeat(depth), "</a>".repeat(depth));
    let once = formatted(&text, WIDTH);
    assert!(once.len() < depth * 2 * 90);
    assert_eq!(formatted(&once, WIDTH), once);
}

#[test]
fn line_ends_in_values_fit_in_as_they_are_written() {
    for width in 1..40 {
        let once = formatted("<a\nb='x\r\ny' c='z'/>", width);
        assert_eq!(formatted(&once, width), once, "{width}");
    }
}
