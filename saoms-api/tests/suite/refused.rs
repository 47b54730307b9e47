//! Inputs that the macros refuse, with the words and places of the compiler's messages.
//! After a deliberate change of the words: `TRYBUILD=overwrite cargo test -p saoms-api --test suite refused`.

#[test]
fn wrong_declarations_do_not_compile() {
    trybuild::TestCases::new().compile_fail("tests/refused/*.rs");
}
