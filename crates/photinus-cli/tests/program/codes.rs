//! Code books: designed, checked, taken.

use crate::stage::Stage;

const SMALL: &str = "codes design --length 8 --distance 2 --longest-run 3";

#[test]
fn a_designed_book_has_what_was_asked_for() {
    let stage = Stage::new("codes-design");
    let done = stage.run(&format!("{SMALL} --out book.txt"));
    assert_eq!((done.code, done.out.as_str()), (0, ""));
    assert!(done.err.contains("book.txt: ") && done.err.contains("no book has more"), "{}", done.err);
    assert_eq!(stage.run(&format!("{SMALL} -q")).out, stage.read("book.txt"), "the same book again");
    assert_eq!(stage.run("codes check book.txt --distance 2 --longest-run 3 --self-distance 2").code, 0);
    let missed = stage.run("codes check book.txt --distance 3 --duty 0.5..0.5");
    assert_eq!(missed.code, 2);
    assert!(missed.err.contains("error: book.txt: words 0 and 1 are 2 bits apart, not 3"), "{}", missed.err);
    assert!(missed.err.contains("the share of bits that are on is "), "{}", missed.err);
    assert_eq!(stage.run("info book.txt").out, stage.run("codes check book.txt").out);
    let kept = stage.run(&format!("{SMALL} --out book.txt"));
    assert!(kept.code == 2 && kept.err.contains("book.txt: it is there already"), "{}", kept.err);
}

#[test]
fn words_that_are_alike_are_no_book_to_fly_with() {
    let stage = Stage::new("codes-check");
    stage.file("alike.txt", "0,0,1,1\n0,1,0,1\n1,0,0,1\n");
    let done = stage.run("codes check alike.txt");
    assert_eq!(done.code, 2);
    for told in [
        "words 0 and 2 are the same but for their beginning",
        "word 1 repeats itself before its end",
        "word known after   never",
    ] {
        assert!(done.out.contains(told), "{told}: {}", done.out);
    }
    assert_eq!(stage.run("info alike.txt").code, 0, "a book all the same");
}

#[test]
fn books_come_with_the_program() {
    let stage = Stage::new("codes-preset");
    let listed = stage.run("codes preset").out;
    assert!(listed.lines().any(|line| line.starts_with("l18-d3-r2  41 words of 18 bits")), "{listed}");
    assert_eq!(stage.run("codes preset l10-d3-r3 --out book.txt").code, 0);
    assert_eq!(stage.run("codes check book.txt --distance 3 --longest-run 3 --self-distance 2").code, 0);
    assert!(
        stage.run("codes preset nobody").err.contains("nobody: no book of this name; there are l10-d3-r3")
    );
}

#[test]
fn what_cannot_be_designed_is_told() {
    let stage = Stage::new("codes-none");
    for (words, told) in [
        (
            "--length 99 --distance 3",
            "words of 99 bits: designed are words of 2 to 24 bits; give another --length",
        ),
        ("--length 9 --distance 3 --longest-run 1", "no word meets the requirements; allow longer runs"),
        ("--length 9 --distance 3 --duty 0.6..0.4", "such as 0.4..0.6"),
    ] {
        let done = stage.run(&format!("codes design {words}"));
        assert!(done.code == 2 && done.err.contains(told), "{words}: {}", done.err);
    }
}
