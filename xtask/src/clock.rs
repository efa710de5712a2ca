//! Time: of the wall, and of processors, which says more on a machine that has other work.

use std::time::Instant;

/// Seconds of processors so far, as Linux counts them: in hundredths. Elsewhere they are 0.
#[derive(Clone, Copy, Debug)]
pub struct ProcessorSeconds {
    /// Of this process.
    pub own: f64,
    /// Of those that it started and that ended.
    pub children: f64,
}

/// What this process has used so far.
pub fn processor_seconds() -> ProcessorSeconds {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit_once(") ").map_or("", |(_, rest)| rest);
    // User and system time, of this process and then of its children.
    let mut ticks = after_name.split(' ').skip(11).map(|field| field.parse::<f64>().unwrap_or(0.0));
    let mut next = || (ticks.next().unwrap_or(0.0) + ticks.next().unwrap_or(0.0)) / 100.0;
    ProcessorSeconds { own: next(), children: next() }
}

/// Steps and how long they took.
#[derive(Debug, Default)]
pub struct Steps(Vec<(String, f64, f64)>);

impl Steps {
    /// Announces a step, does it, and notes its time, whatever its result.
    pub fn time<T>(&mut self, name: &str, step: impl FnOnce() -> T) -> T {
        crate::shell::say(name);
        let (began, used) = (Instant::now(), processor_seconds().children);
        let result = step();
        let seconds = began.elapsed().as_secs_f64();
        self.0.push((name.to_owned(), seconds, processor_seconds().children - used));
        result
    }

    /// A line for each step, and their sum.
    pub fn table(&self) -> String {
        let sum = |of: fn(&(String, f64, f64)) -> f64| self.0.iter().map(of).sum();
        let all = ("all".to_owned(), sum(|step| step.1), sum(|step| step.2));
        let rows = self.0.iter().chain([&all]);
        let row = |(name, seconds, cpu): &(String, f64, f64)| format!("{seconds:>9.0} {cpu:>9.0}  {name}\n");
        "  seconds       CPU  step\n".to_owned() + &rows.map(row).collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_fails_has_its_line_too() {
        let mut steps = Steps::default();
        assert!(steps.time("one", || Err::<(), _>("no")).is_err());
        let table = steps.table();
        let names: Vec<_> = table.lines().map(|line| line.split_whitespace().last()).collect();
        assert_eq!(names, [Some("step"), Some("one"), Some("all")]);
    }
}
