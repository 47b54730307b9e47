use saoms_api::Class;

#[derive(Class)]
struct Nothing;

#[derive(Class)]
#[class(name = "test.Unsaid")]
struct Unsaid;

#[derive(Class)]
#[class(name = "test.Both", periodic, passive)]
struct Both;

#[derive(Class)]
#[class(name = "test.Typo", periodic, publish(PING))]
struct Typo;

#[derive(Class)]
#[class(name = "test.Twice", periodic, service("a": A), service("a": B))]
struct Twice;

#[derive(Class)]
#[class(name = "test.Same", passive, also("test.Same", number = 1))]
struct Same;

#[derive(Class)]
#[class(name = "test.Wish", passive, reference("a": A, maybe))]
struct Wish;

#[derive(Class)]
#[class(name = "test.Preset", passive, also("test.Other", number = ONE))]
struct Preset;

#[derive(Class)]
#[class(name = "test.Generic", passive)]
struct Generic<T>(T);

fn main() {}
