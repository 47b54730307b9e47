import java.io.IOException;
import java.util.concurrent.Executors;
import java.util.concurrent.ScheduledExecutorService;
import java.util.concurrent.TimeUnit;
import java.util.concurrent.atomic.AtomicIntegerArray;
import java.util.concurrent.atomic.AtomicLong;

/**
 * The lateness of Java's scheduled executors, with the phases, the window and the protocol of the driver's other contenders.
 *
 * Arguments: "per-task" or "pool", tasks, period, warm-up and measured time, the last three in ns.
 */
public final class Lateness {
    private static final int STEP_BITS = 7;
    private static final int VALUE_BITS = 40;

    private static final AtomicIntegerArray COUNTS = new AtomicIntegerArray((VALUE_BITS - STEP_BITS + 1) << STEP_BITS);
    private static final AtomicLong EXECUTIONS = new AtomicLong();

    private static int bucket(long ns) {
        long value = Math.min(Math.max(ns, 0), (1L << VALUE_BITS) - 1);
        int shift = Math.max(64 - Long.numberOfLeadingZeros(value) - (STEP_BITS + 1), 0);
        return (shift << STEP_BITS) + (int) (value >> shift);
    }

    private static long lowerBound(int bucket) {
        int shift = Math.max((bucket >> STEP_BITS) - 1, 0);
        return ((long) (bucket - (shift << STEP_BITS))) << shift;
    }

    private static final class Task implements Runnable {
        private final long period;
        private final long windowStart;
        private final long windowEnd;
        private long due;

        Task(long first, long period, long windowStart, long windowEnd) {
            this.due = first;
            this.period = period;
            this.windowStart = windowStart;
            this.windowEnd = windowEnd;
        }

        @Override
        public void run() {
            long now = System.nanoTime();
            EXECUTIONS.incrementAndGet();
            if (due - windowStart >= 0 && due - windowEnd < 0) {
                COUNTS.incrementAndGet(bucket(now - due));
            }
            due += period;
        }
    }

    private static void sleepUntil(long time) throws InterruptedException {
        long left = time - System.nanoTime();
        if (left > 0) {
            TimeUnit.NANOSECONDS.sleep(left);
        }
    }

    public static void main(String[] arguments) {
        try {
            measure(arguments);
        } catch (Throwable failure) {
            // Out of threads, above all: those that were created would keep the process alive.
            System.err.println(failure.getMessage());
            Runtime.getRuntime().halt(1);
        }
    }

    private static void measure(String[] arguments) throws InterruptedException, IOException {
        boolean perTask = arguments[0].equals("per-task");
        int tasks = Integer.parseInt(arguments[1]);
        long period = Long.parseLong(arguments[2]);
        long warmUp = Long.parseLong(arguments[3]);
        long measured = Long.parseLong(arguments[4]);

        long start = System.nanoTime() + 500_000_000L + 100_000L * tasks;
        long windowStart = start + warmUp;
        long windowEnd = windowStart + measured;
        ScheduledExecutorService pool = perTask ? null : Executors.newScheduledThreadPool(2);
        for (int index = 0; index < tasks; index++) {
            long first = start + period * index / tasks;
            Task task = new Task(first, period, windowStart, windowEnd);
            ScheduledExecutorService executor = perTask ? Executors.newScheduledThreadPool(1) : pool;
            executor.scheduleAtFixedRate(task, first - System.nanoTime(), period, TimeUnit.NANOSECONDS);
        }

        sleepUntil(windowStart);
        System.out.println("begin " + EXECUTIONS.get());
        sleepUntil(windowEnd + Math.max(period, 100_000_000L));
        System.out.println("end " + EXECUTIONS.get());
        System.in.read();
        StringBuilder lines = new StringBuilder();
        for (int bucket = 0; bucket < COUNTS.length(); bucket++) {
            if (COUNTS.get(bucket) > 0) {
                lines.append("late ").append(lowerBound(bucket)).append(' ').append(COUNTS.get(bucket)).append('\n');
            }
        }
        System.out.print(lines);
        System.out.flush();
        Runtime.getRuntime().halt(0);
    }
}
