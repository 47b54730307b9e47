//! Allocates with an allocator of its own: memory that another one made, or that another one frees, ends the process.

use std::alloc::{GlobalAlloc, Layout, System};

use saoms_api::{
    Class, Component, Context, Failure, Message, Publisher, ReportValue, Subscription, Topic, record,
};

/// Each piece of memory begins with a word that tells whose it is.
struct Marked;

const MARK: u64 = 0x5A0_5A05_5A05_A05A;

fn around(layout: Layout) -> (Layout, usize) {
    // A layout that comes from the compiler is far from the largest there can be.
    let (layout, start) = Layout::new::<u64>().extend(layout).expect("a small layout");
    (layout, start)
}

// SAFETY: the memory is that of the system's allocator, with room for the mark in front of it.
unsafe impl GlobalAlloc for Marked {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let (layout, start) = around(layout);
        // SAFETY: as the caller promises.
        unsafe {
            let memory = System.alloc(layout);
            if memory.is_null() {
                return memory;
            }
            memory.cast::<u64>().write(MARK);
            memory.add(start)
        }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        let (layout, start) = around(layout);
        // SAFETY: as the caller promises.
        unsafe {
            let memory = memory.sub(start);
            if memory.cast::<u64>().read() != MARK {
                std::process::abort();
            }
            memory.cast::<u64>().write(0);
            System.dealloc(memory, layout);
        }
    }
}

#[global_allocator]
static MARKED: Marked = Marked;

/// A message with memory in it.
#[derive(Clone, Debug, Message)]
pub struct Note {
    text: String,
    numbers: Vec<u64>,
}

const NOTES: Topic<Note> = Topic::event("NOTES");

/// Says and hears, writes to log, report and journal, fails now and then.
#[derive(Debug, Class)]
#[class(name = "alone.Talker", periodic, publishes(NOTES), subscribes(NOTES))]
pub struct Talker {
    said: Publisher<Note>,
    heard: Subscription<Note>,
}

impl Component for Talker {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Talker { said: Publisher::default(), heard: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.said = context.publish(&NOTES)?;
        self.heard = context.subscribe(&NOTES)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let heard = context.receive(&self.heard).count();
        context.count("notes.heard", heard as i64);
        let text = "a text that lies on the heap ".repeat(20);
        context.info(format_args!("{text}"));
        context.report("notes.text", ReportValue::Map(vec![(text.clone(), ReportValue::Text(text.clone()))]));
        context.effect(record!("heard {heard}", heard = heard as i64));
        context.send(&self.said, Note { text, numbers: (0..100).collect() })?;
        if context.execution() % 10 == 9 { Err("x".repeat(10_000).into()) } else { Ok(()) }
    }
}

saoms_api::plugin! {
    classes: [Talker],
}
