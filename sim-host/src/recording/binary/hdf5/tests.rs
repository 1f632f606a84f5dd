use super::*;
use hdf5_pure::FileBuilder;
use proptest::prelude::*;

fn made() -> Vec<u8> {
    let mut builder = FileBuilder::new();
    builder.create_dataset("time").with_f64_data(&[0.0, 0.1, 0.2]).with_shape(&[3]);
    builder.create_dataset("pair").with_f64_data(&[1.0, 10.0, 2.0, 20.0, 3.0, 30.0]).with_shape(&[3, 2]);
    let mut group = builder.create_group("run");
    group.create_dataset("x").with_f32_data(&[1.0, 2.0, 3.0]);
    builder.add_group(group.finish());
    builder.finish().unwrap()
}

#[test]
fn sets_of_numbers_are_columns() {
    let content = parse(made()).unwrap();
    let of = |name: &str| content.columns.iter().find(|c| c.heading.name == name).unwrap().values.clone();
    assert_eq!(of("time"), [0.0, 0.1, 0.2]);
    assert_eq!(of("pair(:,2)"), [10.0, 20.0, 30.0]);
    assert_eq!(of("run.x"), [1.0, 2.0, 3.0]);
}

#[test]
fn a_matlab_file_of_others_is_read() {
    let Some(path) = crate::recording::tests::data("files/v73.mat") else { return };
    let content = parse(std::fs::read(path).unwrap()).unwrap();
    let of = |name: &str| {
        let column = content.columns.iter().find(|c| c.heading.name == name);
        column.unwrap_or_else(|| panic!("no {name}")).values.clone()
    };
    assert_eq!(of("secondvar"), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(of("data.arr_double"), [1.1, 1.2, 0.3]);
    // MATLAB shows [1 3 5; 2 4 6]' as two columns of three.
    assert_eq!(of("data.arr_two_three(:,1)"), [1.0, 3.0, 5.0]);
    assert!(content.columns.iter().all(|c| c.heading.name != "keys"), "text is no column");
}

proptest! {
    #[test]
    fn no_bytes_crash_it(bytes in prop::collection::vec(any::<u8>(), 0..200), at in 0..3000usize, byte in any::<u8>()) {
        let _ = parse([b"\x89HDF\r\n\x1a\n".to_vec(), bytes].concat());
        let mut damaged = made();
        let n = damaged.len();
        damaged[at % n] = byte;
        let _ = parse(damaged.clone());
        damaged.truncate(at % n);
        let _ = parse(damaged);
    }
}
