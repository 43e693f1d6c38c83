//! Plans from outside.

use crate::stage::Stage;

#[test]
fn the_example_is_planned_told_and_drawn() {
    let stage = Stage::new("plan");
    let example = stage.run("plan --example");
    assert_eq!(example.code, 0);
    stage.file("set-up.toml", &example.out);
    let done = stage.run("plan set-up.toml --out plan");
    assert_eq!(done.code, 0, "{}", done.err);
    for told in
        ["A distance (two spots)", "modulo 60 deg", "6 arms, one LED each", "% of hovering", "IEC 62471:2006"]
    {
        assert!(done.out.contains(told), "{told}: {}", done.out);
    }
    let page = stage.read("plan/index.html");
    assert_eq!(page.matches("<figure>").count(), 4);
    assert!(
        done.out.lines().all(|line| page.contains(&line.replace('<', "&lt;")) || line.is_empty()),
        "{page}"
    );
    let json = stage.run("plan set-up.toml --json");
    assert_eq!(json.out, stage.read("plan/plan.json"), "the same plan, as JSON");
    let kept = stage.run("plan set-up.toml --out plan");
    assert!(kept.code == 2 && kept.err.contains("it is there already"), "{}", kept.err);
}

#[test]
fn parts_say_where_their_numbers_come_from_and_wrong_ones_are_named() {
    let stage = Stage::new("plan-parts");
    let parts = stage.run("plan --parts");
    assert!(parts.code == 0 && parts.out.contains("source = "), "{}", parts.out);
    let text = stage.run("plan --example").out.replace("sunnex-dsl215", "sunny");
    stage.file("set-up.toml", text);
    let refused = stage.run("plan set-up.toml");
    assert_eq!(refused.code, 2);
    assert!(refused.err.contains("lens.part") && refused.err.contains("sunnex-dsl215"), "{}", refused.err);
    assert_eq!(stage.run("plan").code, 2, "a set-up is wanted");
}
