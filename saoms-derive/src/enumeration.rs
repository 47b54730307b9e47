use std::collections::HashSet;

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DataEnum, DeriveInput, Error, Fields, Ident, LitInt, LitStr, Result};

use crate::case::{lower_camel, screaming_snake};
use crate::field::no_generics;
use crate::json::Json;
use crate::literal::Literal;

/// `#[derive(Field)]` on an enum: named integer constants.
pub(crate) fn field(input: &DeriveInput, data: &DataEnum) -> Result<TokenStream> {
    no_generics(&input.generics, "an enumeration")?;
    let variants = unit_variants(input, data)?;
    let (representation, ros) = representation(input)?;
    let numbers = numbers(data)?;
    let ident = &input.ident;

    let mut text = Json::default();
    text.plain(&format!("{{\"enumeration\":\"{ros}\",\"values\":{{"));
    for (place, (variant, number)) in variants.iter().zip(&numbers).enumerate() {
        text.plain(if place > 0 { "," } else { "" });
        text.string(&screaming_snake(variant));
        text.plain(&format!(":{number}"));
    }
    text.plain("}}");
    let text = text.into_text();
    let literals = numbers.iter().map(|number| LitInt::new(&number.to_string(), ident.span())).collect::<Vec<_>>();
    let words: Vec<_> = variants.iter().map(|variant| screaming_snake(variant)).collect();
    let expected = format!("a constant of {ident}");
    Ok(quote! {
        #[automatically_derived]
        impl ::saoms_api::Field for #ident {
            const TYPE: ::saoms_api::host::declaration::ConstText = #text;
            const LEAST_SIZE: usize = <#representation as ::saoms_api::Field>::LEAST_SIZE;
            const VALUE: &'static str = "word";

            fn as_value(&self) -> ::core::option::Option<::saoms_api::Value> {
                ::core::option::Option::Some(::saoms_api::Value::Word(match self {
                    #(#ident::#variants => #words,)*
                }))
            }

            fn of_value(value: ::saoms_api::Value) -> ::core::option::Option<Self> {
                match ::saoms_api::Value::as_text(&value)? {
                    #(#words => ::core::option::Option::Some(#ident::#variants),)*
                    _ => ::core::option::Option::None,
                }
            }

            fn write(&self, writer: &mut ::saoms_api::host::cdr::Writer) {
                let number: #representation = match self {
                    #(#ident::#variants => #literals,)*
                };
                ::saoms_api::Field::write(&number, writer);
            }

            fn read(
                reader: &mut ::saoms_api::host::cdr::Reader<'_>,
            ) -> ::core::result::Result<Self, ::saoms_api::host::cdr::DecodeError> {
                match <#representation as ::saoms_api::Field>::read(reader)? {
                    #(#literals => ::core::result::Result::Ok(#ident::#variants),)*
                    other => ::core::result::Result::Err(::saoms_api::host::cdr::DecodeError::new(
                        ::std::format!("found {other}, expected {}", #expected),
                        reader.offset() - ::core::mem::size_of::<#representation>(),
                    )),
                }
            }
        }
    })
}

/// `#[derive(PropertyField)]`: a choice of texts.
pub(crate) fn property_field(input: &DeriveInput) -> Result<TokenStream> {
    no_generics(&input.generics, "an enumeration")?;
    let Data::Enum(data) = &input.data else {
        return Err(Error::new_spanned(
            &input.ident,
            "`PropertyField` is derived on enums without data; derive `Properties` on a struct that is a complex \
             property",
        ));
    };
    let variants = unit_variants(input, data)?;
    let mut allowed = Vec::new();
    let mut seen = HashSet::new();
    for variant in &data.variants {
        let mut name = lower_camel(&variant.ident);
        for attribute in variant.attrs.iter().filter(|attribute| attribute.path().is_ident("property")) {
            attribute.parse_nested_meta(|meta| {
                if !meta.path.is_ident("name") {
                    return Err(meta.error("expected `name = \"...\"`"));
                }
                name = meta.value()?.parse::<LitStr>()?.value();
                Ok(())
            })?;
        }
        if !seen.insert(name.clone()) {
            return Err(Error::new_spanned(variant, format!("another variant is `{name}`, too")));
        }
        allowed.push(name);
    }
    let mut details = Json::default();
    details.plain(",\"allowed\":");
    details.list(&allowed, |text, allowed| text.string(allowed));
    let (details, ident) = (details.into_text(), &input.ident);
    Ok(quote! {
        #[automatically_derived]
        impl ::saoms_api::PropertyField for #ident {
            const TYPE: ::saoms_api::host::declaration::PropertyShape = {
                use ::saoms_api::host::declaration::{PropertyKind, PropertyShape, Rule};
                const ALLOWED: &[&str] = &[#(#allowed),*];
                PropertyShape::scalar(Rule { allowed: ALLOWED, ..Rule::of(PropertyKind::Enumeration) })
                    .with_details(#details)
            };

            fn from_scalar(
                scalar: &::saoms_api::host::declaration::Scalar,
            ) -> ::core::option::Option<::core::result::Result<Self, ::std::string::String>> {
                match scalar.as_text()?.as_str() {
                    #(#allowed => ::core::option::Option::Some(::core::result::Result::Ok(#ident::#variants)),)*
                    _ => ::core::option::Option::None,
                }
            }

            fn to_value(&self) -> ::core::option::Option<::saoms_api::host::PropertyValue> {
                ::core::option::Option::Some(match self {
                    #(#ident::#variants => ::saoms_api::host::PropertyValue::from(#allowed),)*
                })
            }
        }
    })
}

fn unit_variants<'a>(input: &DeriveInput, data: &'a DataEnum) -> Result<Vec<&'a Ident>> {
    if data.variants.is_empty() {
        return Err(Error::new_spanned(&input.ident, "an enumeration needs at least one variant"));
    }
    let unit = |variant: &'a syn::Variant| match &variant.fields {
        Fields::Unit => Ok(&variant.ident),
        fields => Err(Error::new_spanned(fields, "an enumeration is named constants: its variants carry no data")),
    };
    data.variants.iter().map(unit).collect()
}

/// The Rust type and the ROS 2 name of the integer.
fn representation(input: &DeriveInput) -> Result<(Ident, &'static str)> {
    const TYPES: [(&str, &str); 8] = [
        ("u8", "uint8"),
        ("u16", "uint16"),
        ("u32", "uint32"),
        ("u64", "uint64"),
        ("i8", "int8"),
        ("i16", "int16"),
        ("i32", "int32"),
        ("i64", "int64"),
    ];
    let mut found = (Ident::new("u8", input.ident.span()), "uint8");
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("field")) {
        attribute.parse_nested_meta(|meta| {
            if !meta.path.is_ident("repr") {
                return Err(meta.error("expected `repr = \"u16\"` or another integer type"));
            }
            let text: LitStr = meta.value()?.parse()?;
            let known = TYPES.iter().find(|(rust, _)| *rust == text.value());
            let (rust, ros) =
                known.ok_or_else(|| Error::new(text.span(), "expected one of u8, u16, u32, u64, i8, i16, i32, i64"))?;
            found = (Ident::new(rust, text.span()), ros);
            Ok(())
        })?;
    }
    Ok(found)
}

/// Numbers of the variants: the explicit one, or one more than the number before.
fn numbers(data: &DataEnum) -> Result<Vec<i128>> {
    let mut numbers: Vec<i128> = Vec::new();
    for variant in &data.variants {
        let number = match &variant.discriminant {
            None => numbers.last().map_or(0, |last| last + 1),
            Some((_, expression)) => match Literal::of(expression)? {
                Literal::Number(digits) => {
                    digits.parse().map_err(|_| Error::new_spanned(expression, "expected a whole number"))?
                }
                _ => return Err(Error::new_spanned(expression, "expected a whole number")),
            },
        };
        numbers.push(number);
    }
    Ok(numbers)
}
