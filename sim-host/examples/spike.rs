use shakedown::identify::data::*; use shakedown::identify::fit::*; use shakedown::identify::model::*; use shakedown::identify::evaluate::*;
use shakedown::plant::model::Kind; use shakedown::plant::simulate::Law; use shakedown::plant::effects;
fn main() {
    let rate: f64 = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(200.0);
    let id = std::env::args().nth(2).unwrap_or("coulomb_friction".into());
    let dt = 1.0/rate; let n = (25.0/dt) as usize;
    let mut seed = 12345u64; let mut rnd = move || { seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); ((seed>>33) as f64)/(2f64.powi(31)) };
    let mut gauss = move || { let s: f64 = (0..12).map(|_| rnd()).sum(); s-6.0 };
    let mk = |v: f64, free| Value{value:v, low: v*0.3, high: v*3.0, positive:true, free};
    let truth = Model{kind:Kind::Servo, own: vec![mk(0.69,false), mk(138.0,true), mk(57.65,true), mk(0.242,true)], scale:None, effects: vec![]};
    let mut runs = vec![];
    for r in 0..3 {
        let reference: Vec<f64> = (0..n).map(|k| {let t=k as f64*dt; (0..12).map(|j| {let f=0.15*(1.45f64).powi(j); 0.05/(1.0+j as f64)*(6.28*f*t+1.3*j as f64+r as f64).sin()}).sum::<f64>() * (t/2.0).min(1.0)}).collect();
        runs.push(Run{name:format!("{r}"), dt, from:0.0, ticks:1, input: reference, added: vec![], law: Law::Pi{kp:10.0,ki:1.0}, moving_start:false,
          measured: vec![Measured{channel:Channel::Displacement, values: vec![0.0;n], noise:2e-5, judged:true}, Measured{channel:Channel::Acceleration, values: vec![0.0;n], noise:0.1, judged:true}, Measured{channel:Channel::Command, values: vec![0.0;n], noise:1.0, judged:false}]});
    }
    let ys = Yardsticks{command:0.2, command_rate:1.0, speed:0.242, displacement:0.1, force:1.0, line:50.0};
    let with = Placed::start(effects::entry(&id).unwrap(), 0, &ys).unwrap();
    let t2 = truth.with(with.clone());
    for run in &mut runs { let l = Local::start(&t2, run); let p = predict(&t2, run, &l).unwrap();
        for (m, c) in run.measured.iter_mut().zip(p.channels) { let nz=m.noise; m.values = c.iter().map(|v| v + if m.judged {gauss()*nz} else {0.0}).collect(); } }
    let mut guess = truth.clone(); for v in &mut guess.own { if v.free { v.value *= 1.1; } }
    let t=std::time::Instant::now();
    let mut fit = Fit::begin(guess.clone(), &runs).unwrap(); fit.improve(&runs, Effort::FULL).unwrap();
    println!("baseline chi2 {} evals {} in {:?}", fit.chi2(), fit.evaluations, t.elapsed());
    let ys = Yardsticks::of(&runs, 1.0); println!("{ys:?}");
    for k in 0..9 { let Some(p) = Placed::start(effects::entry(&id).unwrap(), k, &ys) else {break};
      let t=std::time::Instant::now();
      let mut f2 = Fit::resume(fit.model.with(p), fit.locals.clone(), &runs).unwrap(); f2.improve(&runs, Effort::FULL).unwrap();
      println!("start {k}: chi2 {} evals {} in {:?}", f2.chi2(), f2.evaluations, t.elapsed());
      for ((n,v),d) in f2.model.names().iter().zip(f2.model.values()).zip(f2.deviations()) { println!("   {n} {} +- {d}", v.value); }
    }
}
