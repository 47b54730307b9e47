use std::collections::HashMap;

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};
use syn::spanned::Spanned;
use syn::{Attribute, Data, DeriveInput, Error, Expr, Fields, Ident, LitStr, Result, Token, Type};

use crate::case::lower_camel;
use crate::docs::docs;
use crate::field::struct_fields;
use crate::json::{self, Json};
use crate::literal::{self, Literal};
use crate::parts::texts;
use crate::range::Range;

/// A field.
enum Member<'a> {
    Own(Box<Property<'a>>),
    /// The fields of another property struct in the place of this one.
    Flat(&'a Ident, &'a Type),
}

/// One field with its attributes.
struct Property<'a> {
    field: &'a Ident,
    of: &'a Type,
    name: String,
    doc: String,
    default: Option<(Expr, String)>,
    range: Option<Range>,
    unit: String,
    allowed: Vec<String>,
    unique: String,
    required_text: bool,
    live: bool,
    speaker: bool,
    language: String,
    plays: Vec<String>,
}

/// `#[derive(Properties)]`.
pub(crate) fn properties(input: &DeriveInput) -> Result<TokenStream> {
    let members = members(input)?;
    let declaration = declaration(&members);
    let names = members.iter().map(Member::names);
    let reads = members.iter().map(Member::read);
    let ident = &input.ident;
    let checks = members.iter().map(|member| match member {
        Member::Own(property) => property.checks(),
        Member::Flat(field, _) => quote_spanned! {field.span()=>
            const _: () = ::core::assert!(
                ::saoms_api::generated::are_distinct(<#ident as ::saoms_api::Properties>::NAMES),
                "a property inside has the same name as a property beside it",
            );
        },
    });
    Ok(quote! {
        #[automatically_derived]
        impl ::saoms_api::Properties for #ident {
            const DECLARATION: &'static str = #declaration;
            const NAMES: &'static [&'static str] = {
                const PARTS: &[&[&str]] = &[#(#names),*];
                &::saoms_api::generated::all_names::<{ ::saoms_api::generated::count(PARTS) }>(PARTS)
            };

            fn from_values(
                values: &[(::saoms_api::host::SmolStr, ::saoms_api::host::PropertyValue)],
            ) -> ::core::result::Result<Self, ::saoms_api::Failure> {
                fn make(
                    given: &mut ::saoms_api::generated::Values<'_>,
                ) -> ::core::result::Result<#ident, ::std::boxed::Box<::saoms_api::Failure>> {
                    // Of a struct without properties none is taken.
                    let _ = &given;
                    ::core::result::Result::Ok(#ident { #(#reads),* })
                }
                ::saoms_api::generated::read(values, <Self as ::saoms_api::Properties>::NAMES, make)
            }
        }

        #[automatically_derived]
        impl ::saoms_api::PropertyField for #ident {
            const TYPE: ::saoms_api::host::declaration::PropertyShape = {
                use ::saoms_api::host::declaration::{PropertyKind, PropertyShape, Rule, ConstText};
                const PARTS: &[ConstText] = &[
                    ConstText::Plain(",\"properties\":"),
                    ConstText::Plain(<#ident as ::saoms_api::Properties>::DECLARATION),
                ];
                PropertyShape::scalar(Rule::of(PropertyKind::Complex)).with_details(ConstText::Joined(PARTS))
            };

            fn from_value(
                value: &::saoms_api::host::PropertyValue,
                _: &::saoms_api::host::declaration::Rule<'_>,
            ) -> ::core::result::Result<Self, ::std::string::String> {
                ::saoms_api::generated::complex(value)
            }
        }

        #(#checks)*
    })
}

/// `#[derive(WriteProperties)]`.
pub(crate) fn write_properties(input: &DeriveInput) -> Result<TokenStream> {
    let (ident, members) = (&input.ident, members(input)?);
    let writes = members.iter().map(Member::write);
    Ok(quote! {
        #[automatically_derived]
        impl ::saoms_api::host::WriteProperties for #ident {
            fn to_values(
                &self,
            ) -> ::std::vec::Vec<(::saoms_api::host::SmolStr, ::saoms_api::host::PropertyValue)> {
                let mut values = ::std::vec::Vec::new();
                #(#writes)*
                values
            }
        }
    })
}

/// The fields of a property struct.
fn members(input: &DeriveInput) -> Result<Vec<Member<'_>>> {
    struct_fields(input, "a property struct")?;
    let mut members: Vec<Member<'_>> = Vec::new();
    let mut fields = HashMap::new();
    if let Data::Struct(data) = &input.data
        && let Fields::Named(named) = &data.fields
    {
        for field in &named.named {
            let Some(ident) = &field.ident else { continue };
            if is_flat(&field.attrs)? {
                members.push(Member::Flat(ident, &field.ty));
                continue;
            }
            let property = Property::of(ident, &field.ty, &field.attrs)?;
            if let Some(other) = fields.insert(property.name.clone(), ident) {
                let message = format!("field `{other}` is the property `{}`, too", property.name);
                return Err(Error::new_spanned(ident, message));
            }
            members.push(Member::Own(Box::new(property)));
        }
    }
    Ok(members)
}

/// The JSON array.
fn declaration(members: &[Member<'_>]) -> TokenStream {
    let mut text = Json::default();
    // Each with a comma before it, which the first one loses.
    for member in members {
        match member {
            Member::Own(property) => {
                text.plain(",");
                Property::declare(&mut text, property);
            }
            Member::Flat(_, of) => {
                let inner = quote_spanned!(of.span()=> <#of as ::saoms_api::Properties>::DECLARATION);
                text.text(quote!(::saoms_api::host::declaration::ConstText::Joined(
                    &::saoms_api::generated::continued(#inner)
                )));
            }
        }
    }
    let items = json::flat(&text.into_text());
    json::flat(&quote!({
        const ITEMS: &str = #items;
        const PARTS: &[::saoms_api::host::declaration::ConstText] = &::saoms_api::generated::list(ITEMS);
        ::saoms_api::host::declaration::ConstText::Joined(PARTS)
    }))
}

/// True if the attributes of a field are `#[property(flatten)]`.
fn is_flat(attributes: &[Attribute]) -> Result<bool> {
    let mut flat = None;
    let mut others = 0;
    for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("property")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("flatten") {
                flat = Some(meta.path.span());
                return Ok(());
            }
            others += 1;
            // What else is said is read by `Property::of`.
            while !meta.input.is_empty() && !meta.input.peek(Token![,]) {
                meta.input.parse::<proc_macro2::TokenTree>()?;
            }
            Ok(())
        })?;
    }
    match flat {
        Some(span) if others > 0 => {
            Err(Error::new(span, "`flatten` allows no other options: the inner properties have their own"))
        }
        found => Ok(found.is_some()),
    }
}

impl Member<'_> {
    /// An expression of type `&[&str]`.
    fn names(&self) -> TokenStream {
        match self {
            Member::Own(property) => {
                let name = &property.name;
                quote!(&[#name])
            }
            Member::Flat(_, of) => quote!(<#of as ::saoms_api::Properties>::NAMES),
        }
    }

    /// The field's initialiser in `from_values`.
    fn read(&self) -> TokenStream {
        match self {
            Member::Own(property) => property.read(),
            Member::Flat(field, of) => quote! {
                #field: ::saoms_api::generated::flat::<#of>(given)?
            },
        }
    }

    /// The statement of `to_values` for the field.
    fn write(&self) -> TokenStream {
        match self {
            Member::Own(property) => {
                let (field, of, name) = (property.field, property.of, &property.name);
                quote_spanned! {field.span()=>
                    const {
                        let kind = <#of as ::saoms_api::PropertyField>::TYPE.rule.kind;
                        let is_complex =
                            ::core::matches!(kind, ::saoms_api::host::declaration::PropertyKind::Complex);
                        ::core::assert!(!is_complex, "a complex property cannot be written");
                    }
                    let value = ::saoms_api::PropertyField::to_value(&self.#field);
                    values.extend(value.map(|value| (#name.into(), value)));
                }
            }
            Member::Flat(field, _) => {
                quote!(values.extend(::saoms_api::host::WriteProperties::to_values(&self.#field));)
            }
        }
    }
}

impl<'a> Property<'a> {
    fn of(field: &'a Ident, of: &'a Type, attributes: &[Attribute]) -> Result<Property<'a>> {
        let mut property = Property {
            field,
            of,
            name: lower_camel(field),
            doc: docs(attributes),
            default: None,
            range: None,
            unit: String::new(),
            allowed: Vec::new(),
            unique: String::new(),
            required_text: false,
            live: false,
            speaker: false,
            language: String::new(),
            plays: Vec::new(),
        };
        for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("property")) {
            attribute.parse_nested_meta(|meta| {
                let text = || meta.value()?.parse::<LitStr>().map(|text| text.value());
                if meta.path.is_ident("name") {
                    property.name = text()?;
                } else if meta.path.is_ident("unit") {
                    property.unit = text()?;
                } else if meta.path.is_ident("unique") {
                    property.unique = text()?;
                } else if meta.path.is_ident("default") {
                    let expression: Expr = meta.value()?.parse()?;
                    let text = Literal::of(&expression)?.text();
                    property.default = Some((expression, text));
                } else if meta.path.is_ident("language") {
                    property.language = text()?;
                } else if meta.path.is_ident("range") {
                    property.range = Some(Range::of(&meta.value()?.parse()?)?);
                } else if meta.path.is_ident("allowed") {
                    property.allowed = texts(meta.input)?;
                } else if meta.path.is_ident("plays") {
                    property.plays = texts(meta.input)?;
                } else if meta.path.is_ident("required_text") {
                    property.required_text = true;
                } else if meta.path.is_ident("live") {
                    property.live = true;
                } else if meta.path.is_ident("speaker") {
                    property.speaker = true;
                } else {
                    return Err(meta.error(
                        "expected one of `name`, `default`, `range`, `unit`, `allowed`, `unique`, `required_text`, \
                         `live`, `speaker`, `language`, `plays`, `flatten`",
                    ));
                }
                Ok(())
            })?;
        }
        if property.language.is_empty() && !property.plays.is_empty() {
            return Err(Error::new_spanned(field, "`plays` needs the `language` whose events are played"));
        }
        property.default_fits()?;
        Ok(property)
    }

    fn default_fits(&self) -> Result<()> {
        let Some((expression, text)) = &self.default else { return Ok(()) };
        if self.range.as_ref().is_some_and(|range| !range.holds(text)) {
            return Err(Error::new_spanned(expression, "the default is out of the property's own range"));
        }
        if !self.allowed.is_empty() && !self.allowed.contains(text) {
            return Err(Error::new_spanned(expression, "the default is not among the allowed values"));
        }
        if self.required_text && text.trim().is_empty() {
            return Err(Error::new_spanned(expression, "the default is empty, which `required_text` forbids"));
        }
        Ok(())
    }

    /// Constants that do not compile when the default or a bound is not of the field's type.
    fn checks(&self) -> TokenStream {
        const NUMBERS: [&str; 12] =
            ["bool", "f32", "f64", "usize", "i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"];
        let (of, name) = (self.of, &self.name);
        let plain = matches!(of, Type::Path(path) if NUMBERS.iter().any(|number| path.path.is_ident(number)));
        let bounds = self.range.iter().flat_map(|range| &range.bounds);
        let literals: Vec<_> = self.default.iter().map(|(default, _)| default).chain(bounds).collect();
        if plain {
            return quote!(#(const _: #of = #literals;)*);
        }
        let default = self.default.iter().map(|(default, text)| {
            let message = format!("the property `{name}` does not allow its default");
            quote_spanned! {default.span()=>
                ::core::assert!(
                    ::saoms_api::generated::default_fits(&RULE, #text, DEFAULT),
                    #message,
                );
            }
        });
        let mut checks: Vec<_> = default.collect();
        if let Some(range) = &self.range
            && let Some(bound) = range.bounds.first()
        {
            let message =
                format!("the range of property `{name}` does not suit its type: expected numbers or durations");
            let ends = [
                (&range.min, quote!(RULE.min)),
                (&range.max, quote!(RULE.max)),
                (&range.exclusive_max, quote!(RULE.exclusive_max)),
            ];
            let ends = ends.iter().filter(|(text, _)| text.is_some()).map(|(_, end)| end);
            checks.push(quote_spanned! {bound.span()=>
                ::core::assert!(true #(&& #ends.is_some())*, #message);
            });
        }
        if self.required_text || !self.allowed.is_empty() {
            let message =
                format!("property `{name}` is not a string: `allowed` and `required_text` do not suit its type");
            checks.push(quote_spanned! {self.field.span()=>
                ::core::assert!(::core::matches!(RULE.kind, ::saoms_api::host::declaration::PropertyKind::String), #message);
            });
        }
        if checks.is_empty() {
            return TokenStream::new();
        }
        let constants = self.constants();
        quote! {
            const _: () = {
                #constants
                #(#checks)*
            };
        }
    }

    /// Its rule as a constant, and its default, if it has one.
    fn constants(&self) -> TokenStream {
        let rule = self.rule();
        let default = self.default.iter().map(|(_, text)| {
            let number = literal::number(text);
            quote! {
                const DEFAULT: &::saoms_api::host::declaration::Scalar =
                    &::saoms_api::host::declaration::Scalar::of_literal(RULE.kind, #text, #number);
            }
        });
        quote! {
            const RULE: ::saoms_api::host::declaration::Rule<'static> = #rule;
            #(#default)*
        }
    }

    fn rule(&self) -> TokenStream {
        let of = self.of;
        let some = |text: &Option<String>| {
            text.as_ref().map(|text| {
                let number = literal::number(text);
                quote!(::saoms_api::host::declaration::Bound::of_literal(
                    <#of as ::saoms_api::PropertyField>::TYPE.rule.kind, #text, #number
                ))
            })
        };
        let none = quote!(::core::option::Option::None);
        let mut members = Vec::new();
        if let Some(range) = &self.range {
            members.extend(some(&range.min).map(|min| quote!(min: #min)));
            match (some(&range.max), some(&range.exclusive_max)) {
                (Some(max), _) => members.push(quote!(max: #max)),
                (None, Some(max)) => members.push(quote!(max: #none, exclusive_max: #max)),
                (None, None) => {}
            }
        }
        if !self.unit.is_empty() {
            let unit = &self.unit;
            members.push(quote!(unit: ::core::option::Option::Some(#unit)));
        }
        if !self.allowed.is_empty() {
            let allowed = &self.allowed;
            members.push(quote!(allowed: &[#(#allowed),*]));
        }
        if self.required_text {
            members.push(quote!(non_empty: true));
        }
        quote! {
            ::saoms_api::host::declaration::Rule {
                #(#members,)*
                ..<#of as ::saoms_api::PropertyField>::TYPE.rule
            }
        }
    }

    /// The field's initialiser in `from_values`.
    fn read(&self) -> TokenStream {
        let (field, name, constants) = (self.field, &self.name, self.constants());
        let default = match self.default {
            Some(_) => quote!(::core::option::Option::Some(DEFAULT)),
            None => quote!(::core::option::Option::None),
        };
        quote! {
            #field: {
                #constants
                ::saoms_api::generated::property(given, #name, #default, &RULE)?
            }
        }
    }

    /// The property's JSON object.
    fn declare(text: &mut Json, property: &Property<'_>) {
        let (of, rule) = (property.of, property.rule());
        let shape = quote!(<#of as ::saoms_api::PropertyField>::TYPE);
        text.plain("{\"name\":");
        text.string(&property.name);
        text.plain(",\"type\":");
        text.quoted(quote!(#shape.rule.kind.name()));
        text.member("doc", &property.doc);
        text.member("unit", &property.unit);
        for (label, bound) in
            [(",\"min\":", quote!(min)), (",\"max\":", quote!(max)), (",\"exclusiveMax\":", quote!(exclusive_max))]
        {
            text.text(quote! {{
                const RULE: ::saoms_api::host::declaration::Rule<'static> = #rule;
                const PARTS: &[::saoms_api::host::declaration::ConstText] =
                    &::saoms_api::host::declaration::PropertyShape::bound(RULE.kind, #label, RULE.#bound);
                ::saoms_api::host::declaration::ConstText::Joined(PARTS)
            }});
        }
        let flag = |member: &str, condition: TokenStream| {
            quote! {
                if #condition {
                    ::saoms_api::host::declaration::ConstText::Plain(#member)
                } else {
                    ::saoms_api::host::declaration::ConstText::EMPTY
                }
            }
        };
        match &property.default {
            Some((_, default)) => text.plain(&format!(",\"default\":{}", json::quoted(default))),
            None => text.text(flag(",\"required\":true", quote!(!#shape.optional))),
        }
        if !property.allowed.is_empty() {
            text.plain(",\"allowed\":");
            text.list(&property.allowed, |text, allowed| text.string(allowed));
        }
        if property.required_text {
            text.plain(",\"nonEmpty\":true");
        }
        if property.live {
            text.plain(",\"live\":true");
        }
        if property.speaker {
            text.plain(",\"speaker\":true");
        }
        text.text(flag(",\"many\":true", quote!(#shape.many)));
        text.member("unique", &property.unique);
        text.member("language", &property.language);
        if !property.plays.is_empty() {
            text.plain(",\"plays\":");
            text.list(&property.plays, |text, word| text.string(word));
        }
        text.text(quote!(#shape.details));
        text.plain("}");
    }
}
