//! Ticks per second on one core of this machine: `cargo bench`. Only ratios between arithmetics in
//! one run are meaningful.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use host_sim::model_muscle;
use host_sim::reference::{self, Mode, Simulation};
use host_sim::scenario::paper_muscle;
use std::hint::black_box;
use vm_nostd as vm;

const FIBER_TYPES: usize = 2;
const MUSCLES: usize = 8;
const PATH: f64 = 0.16;

/// Activation varies, so that consecutive ticks differ.
fn activation(tick: u32) -> f64 {
    f64::from(tick % 1000) / 1000.0
}

fn input<S: vm::Scalar>(tick: u32) -> vm::Input<S> {
    vm::Input {
        activation: S::from_f64(activation(tick)),
        path_length: S::path_length(PATH),
        stimulation_frequency: S::quantity(20.0),
    }
}

fn built<S: vm::Scalar, R: vm::Recruitment<S, FIBER_TYPES, Units = ()>>()
-> (vm::Muscle<S, R, FIBER_TYPES>, vm::State<S, R, FIBER_TYPES>) {
    let params = model_muscle::params(&paper_muscle());
    let muscle = vm::Muscle::build(&params, vm::TimeStep::MILLISECOND).expect("the paper's muscle");
    let state = muscle.rest(S::path_length(PATH)).expect("a resting length");
    (muscle, state)
}

fn one_muscle<S: vm::Scalar, R: vm::Recruitment<S, FIBER_TYPES, Units = ()>>(
    criterion: &mut Criterion,
    mode: &str,
    arithmetic: &str,
) {
    let mut group = criterion.benchmark_group(mode);
    group.throughput(Throughput::Elements(1));
    group.bench_function(BenchmarkId::from_parameter(arithmetic), |bencher| {
        let (muscle, mut state) = built::<S, R>();
        let mut tick = 0;
        bencher.iter(|| {
            tick += 1;
            muscle.step(&mut state, black_box(input(tick)))
        });
    });
}

fn bank<S: vm::Scalar>(criterion: &mut Criterion, arithmetic: &str) {
    let mut group = criterion.benchmark_group("bank of 8");
    group.throughput(Throughput::Elements(MUSCLES as u64));
    group.bench_function(BenchmarkId::from_parameter(arithmetic), |bencher| {
        let mut bank = vm::Bank::<S, FIBER_TYPES, MUSCLES>::new();
        for place in 0..MUSCLES {
            let banked = if place % 2 == 0 {
                let (muscle, state) = built::<S, vm::NaturalContinuous>();
                vm::BankedMuscle::Continuous(muscle, state)
            } else {
                let (muscle, state) = built::<S, vm::IntramuscularFes>();
                vm::BankedMuscle::Fes(muscle, state)
            };
            bank.add(banked).expect("room for all");
        }
        let mut tick = 0;
        bencher.iter(|| {
            tick += 1;
            bank.step(black_box(&[input(tick); MUSCLES]))
        });
    });
}

fn reference(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("continuous");
    group.throughput(Throughput::Elements(1));
    group.bench_function(BenchmarkId::from_parameter("reference"), |bencher| {
        let mut simulation = Simulation::at_rest(paper_muscle(), Mode::Continuous, 1e-3, PATH);
        let mut tick = 0;
        bencher.iter(|| {
            tick += 1;
            let input = reference::Input {
                activation: activation(tick),
                path_length: PATH,
                stimulation_frequency: 20.0,
            };
            simulation.step(black_box(input)).expect("a step")
        });
    });
}

fn all(criterion: &mut Criterion) {
    one_muscle::<f32, vm::NaturalContinuous>(criterion, "continuous", "f32");
    one_muscle::<vm::Fixed, vm::NaturalContinuous>(criterion, "continuous", "fixed");
    reference(criterion);
    one_muscle::<f32, vm::IntramuscularFes>(criterion, "fes", "f32");
    one_muscle::<vm::Fixed, vm::IntramuscularFes>(criterion, "fes", "fixed");
    bank::<f32>(criterion, "f32");
    bank::<vm::Fixed>(criterion, "fixed");
}

criterion_group!(ticks, all);
criterion_main!(ticks);
