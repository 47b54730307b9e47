//! An execution across the boundary to plugins allocates nothing.

#[allow(dead_code, reason = "other tests use the rest")]
#[path = "suite/components/host.rs"]
mod host;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use saoms_api::boundary::class_table;
use saoms_api::{Class, Component, Context, Failure};
use saoms_core::plugin::ImportedClass;

use host::FakeHost;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator, which counts what a thread asks it for.
struct Counting;

// SAFETY: all is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Asks for what it can.
#[derive(Class)]
#[class(name = "test.Asking", periodic)]
struct Asking {
    asked: u64,
}

impl Component for Asking {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Asking { asked: 0 })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let times = context.now().as_nanos() + context.due().as_nanos() + context.period().as_millis() as u64;
        let others = context.name().len() as u64 + context.chance().next_u64() % 2 + context.execution();
        self.asked = self.asked.wrapping_add(times + others + u64::from(context.cancelled()));
        Ok(())
    }
}

#[test]
fn an_execution_across_the_boundary_allocates_nothing() {
    let mut host = FakeHost::new();
    // SAFETY: the functions of the table are this crate's own.
    let class = unsafe { ImportedClass::new(&class_table::<Asking>(), "test") };
    let mut asking = class.construct(&[]).unwrap();
    asking.initialize(&mut Context::new(&mut host, &[])).unwrap();
    let before = COUNT.get();
    for _ in 0..1000 {
        asking.execute(&mut Context::new(&mut host, &[])).unwrap();
    }
    assert_eq!(COUNT.get() - before, 0);
    let before = COUNT.get();
    drop(Box::new(before));
    assert!(COUNT.get() > before, "the test has to see what is allocated");
}
