use syn::{Attribute, Expr, ExprLit, Lit, Meta};

/// The text of `///`: lines of a paragraph are joined, paragraphs stand on lines of their own.
pub(crate) fn docs(attributes: &[Attribute]) -> String {
    let mut text = String::new();
    for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("doc")) {
        let Meta::NameValue(meta) = &attribute.meta else { continue };
        let Expr::Lit(ExprLit { lit: Lit::Str(line), .. }) = &meta.value else { continue };
        for line in line.value().lines().map(str::trim).chain(line.value().is_empty().then_some("")) {
            if line.is_empty() {
                text.push('\n');
            } else {
                let glue = if text.is_empty() || text.ends_with('\n') { "" } else { " " };
                text.push_str(glue);
                text.push_str(line);
            }
        }
    }
    text.trim().to_owned()
}
