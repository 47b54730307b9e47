use saoms_api::{Class, Component, Failure, Properties};

#[derive(Class)]
#[class(name = "test.Car", passive)]
struct Car;

impl Component for Car {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Car)
    }
}

#[derive(Class)]
#[class(name = "test.Two", passive)]
struct Two {
    #[extends]
    one: Car,
    #[extends]
    other: Car,
}

#[derive(Class)]
#[class(name = "test.Nameless", passive)]
struct Nameless(#[extends] Car);

#[derive(Class)]
#[class(name = "test.Knows", passive, knowledge = Car)]
struct Knows {
    #[extends]
    car: Car,
}

#[derive(Properties)]
struct CarProperties {
    #[property(default = 1)]
    number: u32,
}

#[derive(Properties)]
struct More {
    #[property(flatten, default = 1)]
    car: CarProperties,
}

#[derive(Properties)]
struct SameName {
    #[property(flatten)]
    car: CarProperties,
    #[property(default = 2)]
    number: u32,
}

fn main() {}
