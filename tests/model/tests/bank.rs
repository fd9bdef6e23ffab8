//! A bank computes the same bits as its muscles do separately.

use vm_nostd::{
    Bank, BankFull, BankedMuscle, ContinuousMuscle, FesMuscle, Fixed, Muscle, Recruitment, State,
    TimeStep,
};
use vm_nostd_cores::{Arithmetic, Inputs, MUSCLE, Scenario};

const CAPACITY: usize = 4;

fn at_rest<S: Arithmetic, R: Recruitment<S, 2, Units = ()>>(
    path: f64,
) -> (Muscle<S, R, 2>, State<S, R, 2>) {
    let muscle = Muscle::<S, R, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("a muscle");
    let state = muscle.rest(S::path_length(path)).expect("a path in range");
    (muscle, state)
}

fn compare_with_single_muscles<S: Arithmetic>() {
    let mut bank = Bank::<S, 2, CAPACITY>::new();
    let (continuous, mut continuous_state) = at_rest(0.16);
    let (fes, mut fes_state) = at_rest(0.165);
    assert_eq!(bank.add(BankedMuscle::Continuous(continuous, continuous_state)), Ok(0));
    assert_eq!(bank.add(BankedMuscle::Fes(fes, fes_state)), Ok(1));
    for tick in 0..3_000 {
        let [natural, stimulated] = Inputs::<S>::inputs(&mut Scenario, tick);
        let outputs = bank.step(&[natural, stimulated, natural, natural]);
        let alone = [
            ContinuousMuscle::step(&continuous, &mut continuous_state, natural),
            FesMuscle::step(&fes, &mut fes_state, stimulated),
        ];
        for (banked, alone) in outputs.iter().zip(&alone) {
            assert_eq!(S::force_bits(banked.force), S::force_bits(alone.force), "tick {tick}");
            assert_eq!(banked.status, alone.status);
        }
        assert_eq!(outputs.len(), 2);
    }
}

#[test]
fn a_bank_of_mixed_modes_has_the_bits_of_single_muscles() {
    compare_with_single_muscles::<f32>();
    compare_with_single_muscles::<Fixed>();
}

#[test]
fn a_full_bank_refuses_another_muscle_and_is_unchanged() {
    let mut bank = Bank::<Fixed, 2, CAPACITY>::new();
    let (muscle, state) = at_rest(0.16);
    for place in 0..CAPACITY {
        assert_eq!(bank.add(BankedMuscle::Fes(muscle, state)), Ok(place));
    }
    let refused = bank.add(BankedMuscle::Fes(muscle, state));
    assert_eq!(refused, Err(BankFull { capacity: CAPACITY }));
    assert!(refused.is_err_and(|full| full.to_string().contains("holds 4 muscles")));
    assert_eq!(bank.muscles().len(), CAPACITY);
}
