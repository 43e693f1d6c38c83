//! Any bytes as results, or as spots of another program; what is read is written.
#![no_main]

use photinus_io::results::{CsvWriter, ResultsReader, ResultsWriter};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut json = ResultsWriter::new(std::io::sink(), "fuzz");
    let mut table = CsvWriter::new(std::io::sink(), "fuzz").expect("a sink takes all");
    for record in ResultsReader::new(bytes, "fuzz").flatten() {
        json.write(&record).expect("a sink takes all");
        table.write(&record).expect("a sink takes all");
    }
});
