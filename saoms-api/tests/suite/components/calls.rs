use saoms_api::host::{Reference, Registration, TypedCall};
use saoms_api::{CallError, Class, Component, Context, Failure, Field, interface};

use super::host::{Boundary, FakeHost};

#[derive(Clone, Debug, PartialEq, Field)]
pub(crate) struct Block {
    pub(crate) x: i32,
    pub(crate) y: i32,
}

/// Knows where it is.
#[expect(clippy::too_many_arguments, reason = "six is the most that an operation takes")]
#[interface(name = "test.Gps")]
pub(crate) trait Gps {
    /// Position.
    fn position(&mut self, context: &mut Context<'_>) -> Result<Block, Failure>;

    /// Goes on. The arguments have the names that generated code could use itself.
    fn r#move(
        &mut self,
        context: &mut Context<'_>,
        component: Block,
        call: String,
        invocation: bool,
        own: Vec<u8>,
        index: f64,
        reply: u64,
    ) -> Result<String, Failure>;

    /// Forgets where it is.
    fn reset(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
}

/// The same interface in a library that was built separately.
mod elsewhere {
    use saoms_api::{Context, Failure, Field, interface};

    #[derive(Clone, Debug, PartialEq, Field)]
    pub(crate) struct Block {
        pub(crate) x: i32,
        pub(crate) y: i32,
    }

    #[expect(clippy::too_many_arguments, reason = "six is the most that an operation takes")]
    #[interface(name = "test.Gps")]
    pub(crate) trait Gps {
        fn position(&mut self, context: &mut Context<'_>) -> Result<Block, Failure>;
        fn r#move(
            &mut self,
            context: &mut Context<'_>,
            to: Block,
            name: String,
            sure: bool,
            path: Vec<u8>,
            speed: f64,
            number: u64,
        ) -> Result<String, Failure>;
        fn reset(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
    }
}

#[derive(Class)]
#[class(name = "test.Receiver", passive, service("position": Gps))]
struct Receiver {
    block: Block,
}

impl Component for Receiver {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Receiver { block: Block { x: 3, y: 4 } })
    }
}

impl Gps for Receiver {
    fn position(&mut self, context: &mut Context<'_>) -> Result<Block, Failure> {
        context.info(format_args!("asked"));
        Ok(self.block.clone())
    }

    fn r#move(
        &mut self,
        _: &mut Context<'_>,
        component: Block,
        call: String,
        invocation: bool,
        own: Vec<u8>,
        index: f64,
        reply: u64,
    ) -> Result<String, Failure> {
        self.block = component;
        Ok(format!("{call} {invocation} {own:?} {index} {reply}"))
    }

    fn reset(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Err("there is no way back".into())
    }
}

fn host(boundary: Boundary, service: &'static str) -> FakeHost {
    let registration = Registration::linked().find(|class| class.declaration() == Receiver::DECLARATION).unwrap();
    let mut host = FakeHost::new();
    host.boundary = boundary;
    host.provider = Some((registration.construct(&[]).unwrap(), service));
    host
}

#[test]
fn calls_reach_the_provider_as_values_and_as_bytes() {
    for boundary in [Boundary::None, Boundary::Bytes] {
        let mut host = host(boundary, "position");
        host.run(|context| {
            let gps: GpsReference = context.reference("gps").unwrap();
            assert!(context.is_wired(&gps));
            assert_eq!(gps.position(context), Ok(Block { x: 3, y: 4 }));
            let text = gps.r#move(context, Block { x: -1, y: 9 }, "go".to_owned(), true, vec![1, 2], 0.5, u64::MAX);
            assert_eq!(text.as_deref(), Ok("go true [1, 2] 0.5 18446744073709551615"));
            assert_eq!(gps.position(context), Ok(Block { x: -1, y: 9 }));
            let failure = CallError::Failed { provider: String::new(), failure: "there is no way back".into() };
            assert_eq!(gps.reset(context), Err(failure));
        });
        assert_eq!(host.lines, ["Info: asked", "Info: asked"]);
    }
}

#[test]
fn another_copy_of_the_interface_is_served_once_per_call() {
    let mut host = host(Boundary::None, "position");
    host.run(|context| {
        let gps: elsewhere::GpsReference = context.reference("gps").unwrap();
        assert_eq!(gps.position(context), Ok(elsewhere::Block { x: 3, y: 4 }));
        let to = elsewhere::Block { x: 5, y: 6 };
        let text = gps.r#move(context, to.clone(), "go".to_owned(), false, Vec::new(), 1.0, 0);
        assert_eq!(text.as_deref(), Ok("go false [] 1 0"));
        assert_eq!(gps.position(context), Ok(to));
        assert!(gps.reset(context).is_err());
    });
    assert_eq!(host.lines.len(), 2);
}

#[test]
fn calls_that_do_not_fit_are_refused() {
    let mismatch = |message: &str| Err(CallError::Mismatch { message: message.to_owned() });
    for boundary in [Boundary::None, Boundary::Bytes] {
        let mut wrong_service = host(boundary, "positon");
        let gps = GpsReference::from_index(0);
        let refused = wrong_service.run(|context| gps.position(context).map(|_| ()));
        assert_eq!(refused, mismatch("class `test.Receiver` offers no service `positon`"));

        let mut host = host(boundary, "position");
        let mut unknown = TypedCall::<(), ()>::new(3, ());
        let refused = host.run(|context| context.call(0, &mut unknown));
        assert_eq!(refused, mismatch("interface `test.Gps` has no operation with the number 3"));
        let mut other_arguments = TypedCall::<(u64,), Block>::new(0, (7,));
        let refused = host.run(|context| context.call(0, &mut other_arguments));
        assert_eq!(refused, mismatch("byte 5: found 7 more bytes, expected the end"));
        let mut other_reply = TypedCall::<(), u8>::new(0, ());
        let refused = host.run(|context| context.call(0, &mut other_reply));
        assert_eq!(refused, mismatch("byte 5: found 7 more bytes, expected the end"));
    }
}

#[test]
fn a_reference_without_a_target_says_so() {
    let gps = GpsReference::default();
    let mut host = FakeHost::new();
    let refused = host.run(|context| {
        assert!(!context.is_wired(&gps));
        gps.position(context)
    });
    assert!(matches!(refused, Err(CallError::NotWired { .. })), "{refused:?}");
}
