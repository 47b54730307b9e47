use proc_macro2::TokenStream;
use quote::quote;

/// A JSON text whose parts are known here, or only as constants of the program that is compiled.
#[derive(Default)]
pub(crate) struct Json {
    plain: String,
    parts: Vec<TokenStream>,
}

impl Json {
    /// Text as it stands.
    pub(crate) fn plain(&mut self, text: &str) {
        self.plain.push_str(text);
    }

    /// A JSON string.
    pub(crate) fn string(&mut self, text: &str) {
        self.plain.push_str(&quoted(text));
    }

    /// `,"name":"text"`, or nothing where the text is empty.
    pub(crate) fn member(&mut self, name: &str, text: &str) {
        if !text.is_empty() {
            self.plain(&format!(",{}:{}", quoted(name), quoted(text)));
        }
    }

    /// An expression of type `saoms_api::host::declaration::ConstText`.
    pub(crate) fn text(&mut self, text: TokenStream) {
        self.flush();
        self.parts.push(text);
    }

    /// An expression of type `&'static str` that holds JSON.
    pub(crate) fn json(&mut self, text: TokenStream) {
        self.text(quote!(::saoms_api::host::declaration::ConstText::Plain(#text)));
    }

    /// An expression of type `&'static str` that is to become a JSON string.
    pub(crate) fn quoted(&mut self, text: TokenStream) {
        self.text(quote!(::saoms_api::host::declaration::ConstText::Quoted(#text)));
    }

    /// `[a,b,c]`, where `element` writes each item.
    pub(crate) fn list<T>(&mut self, items: impl IntoIterator<Item = T>, mut element: impl FnMut(&mut Json, T)) {
        self.plain("[");
        for (place, item) in items.into_iter().enumerate() {
            if place > 0 {
                self.plain(",");
            }
            element(self, item);
        }
        self.plain("]");
    }

    fn flush(&mut self) {
        if !self.plain.is_empty() {
            let plain = std::mem::take(&mut self.plain);
            self.parts.push(quote!(::saoms_api::host::declaration::ConstText::Plain(#plain)));
        }
    }

    /// An expression of type `saoms_api::host::declaration::ConstText`, for constants.
    pub(crate) fn into_text(mut self) -> TokenStream {
        self.flush();
        let parts = self.parts;
        quote!({
            const PARTS: &[::saoms_api::host::declaration::ConstText] = &[#(#parts),*];
            ::saoms_api::host::declaration::ConstText::Joined(PARTS)
        })
    }
}

/// An expression of type `&'static str` for a constant: all of the text, which is an expression of type `Text`.
pub(crate) fn flat(text: &TokenStream) -> TokenStream {
    quote!({
        const TEXT: ::saoms_api::host::declaration::ConstText = #text;
        const BYTES: [u8; TEXT.length()] = TEXT.bytes();
        ::saoms_api::host::declaration::text(&BYTES)
    })
}

/// The text as a JSON string.
pub(crate) fn quoted(text: &str) -> String {
    let mut json = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' => json.push_str("\\\""),
            '\\' => json.push_str("\\\\"),
            '\n' => json.push_str("\\n"),
            '\0'..='\x1f' => json.push_str(&format!("\\u{:04x}", u32::from(letter))),
            _ => json.push(letter),
        }
    }
    json.push('"');
    json
}
