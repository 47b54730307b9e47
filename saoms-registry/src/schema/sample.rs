use saoms_api::Chance;
use saoms_api::host::cdr::Writer;

use super::{Number, Schema, Type};

impl Schema {
    /// The bytes of a message with any values, for tests: texts and sequences are short, and often empty.
    pub fn sample(&self, chance: &mut Chance) -> Vec<u8> {
        let mut writer = Writer::new();
        message(self, chance, &mut writer);
        writer.into_bytes()
    }
}

fn message(schema: &Schema, chance: &mut Chance, writer: &mut Writer) {
    if schema.fields.is_empty() {
        writer.scalar([0]);
    }
    schema.fields.iter().for_each(|field| value(&field.kind, chance, writer));
}

fn value(kind: &Type, chance: &mut Chance, writer: &mut Writer) {
    match kind {
        Type::Bool => writer.scalar([u8::from(chance.chance(0.5))]),
        Type::Number(number) => scalar(*number, chance, writer),
        Type::Time => scalar(Number::Uint64, chance, writer),
        Type::String => text(usize::MAX, chance, writer),
        Type::Enumeration(number, values) => {
            let constant = chance.pick(values).map_or(0, |(_, constant)| *constant);
            integer(*number, constant as u64, writer);
        }
        Type::Message(schema) => message(schema, chance, writer),
        Type::Sequence(element) => sequence(element, 3, chance, writer),
        Type::Array(element, count) => (0..*count).for_each(|_| value(element, chance, writer)),
        Type::Bounded(content, most) => match &**content {
            Type::Sequence(element) => sequence(element, (*most).min(3), chance, writer),
            _ => text(*most, chance, writer),
        },
        Type::Optional(element) => sequence(element, 1, chance, writer),
    }
}

fn text(most: usize, chance: &mut Chance, writer: &mut Writer) {
    let mut text: String =
        (0..chance.below(5)).map(|_| chance.pick(&['a', ' ', '7', 'ü', '\0']).unwrap_or(&'a')).collect();
    while text.len() > most {
        text.pop();
    }
    writer.string(&text);
}

fn sequence(element: &Type, most: usize, chance: &mut Chance, writer: &mut Writer) {
    let count = chance.below(most as u64 + 1);
    writer.length(count as usize);
    (0..count).for_each(|_| value(element, chance, writer));
}

/// Small numbers and the bounds are what code trips over.
fn scalar(number: Number, chance: &mut Chance, writer: &mut Writer) {
    let bits = match chance.below(4) {
        0 => 0,
        1 => u64::MAX,
        2 => chance.next_u64(),
        _ => chance.below(12),
    };
    match number {
        Number::Float32 => writer.scalar((bits as f32).to_le_bytes()),
        Number::Float64 if bits == u64::MAX => writer.scalar(f64::NAN.to_le_bytes()),
        Number::Float64 => writer.scalar((bits as f64).to_le_bytes()),
        number => integer(number, bits, writer),
    }
}

fn integer(number: Number, bits: u64, writer: &mut Writer) {
    match number.size() {
        1 => writer.scalar((bits as u8).to_le_bytes()),
        2 => writer.scalar((bits as u16).to_le_bytes()),
        4 => writer.scalar((bits as u32).to_le_bytes()),
        _ => writer.scalar(bits.to_le_bytes()),
    }
}
