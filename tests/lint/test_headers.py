"""What the first bytes of a mesh say: real meshes are fine, each of them cut short is not."""

import struct

import pytest

from kinetostat.lint.headers import HEAD, MOST_FACETS, Kind, fault_of
from kinetostat.lint.meshes import MANY, named_files
from kinetostat.lint.subject import subject_of
from kinetostat.urdf.files import example_robots


def binary_stl(count, *, head=b"made by hand", size=None):
    """Return the head of a binary STL and its size, without the facets."""
    return head.ljust(80) + struct.pack("<I", count), 84 + 50 * count if size is None else size


def example_meshes():
    folders = {path.parents[1] for path in example_robots().values()}
    return sorted(
        p for f in folders for p in f.rglob("*") if p.suffix.lower() in (".stl", ".dae", ".obj", ".ply", ".glb")
    )


def test_no_real_mesh_is_called_unreadable():
    meshes = example_meshes()
    assert len(meshes) > 500
    for path in meshes:
        data = path.read_bytes()
        fault = fault_of(data[:HEAD], len(data), path.suffix.lower()[1:])
        assert fault is None or fault.kind is Kind.SOLID, f"{path}: {fault}"


def test_a_real_binary_stl_that_is_cut_anywhere_is_told():
    path = next(p for p in example_meshes() if p.suffix.lower() == ".stl" and not p.read_bytes().startswith(b"solid"))
    data = path.read_bytes()
    for size in (1, 50, 83, 84, 100, len(data) // 2, len(data) - 50, len(data) - 1):
        fault = fault_of(data[:size][:HEAD], size, "stl")
        assert fault is not None
        assert fault.kind is Kind.UNREADABLE


@pytest.mark.parametrize("extension", ["stl", "dae", "obj", "gltf", "glb", "ply", "fbx", ""])
def test_an_empty_file_is_unreadable_whatever_it_is_called(extension):
    fault = fault_of(b"", 0, extension)
    assert fault is not None
    assert fault.kind is Kind.UNREADABLE


@pytest.mark.parametrize(
    ("count", "kind"), [(1, None), (MOST_FACETS, None), (MOST_FACETS + 1, Kind.LARGE), (8_000_000, Kind.LARGE)]
)
def test_a_large_stl_is_told_by_its_header_alone(count, kind):
    fault = fault_of(*binary_stl(count), "stl")
    assert (fault.kind if fault else None) is kind


def test_a_count_of_facets_far_beyond_the_file_is_no_count():
    fault = fault_of(*binary_stl(2**32 - 1, size=684), "stl")
    assert fault is not None
    assert "neither" in fault.text


@pytest.mark.parametrize(
    ("head", "extension"),
    [
        (b"\x89PNG\r\n\x1a\n", "png"),
        (b"\xff\xd8\xff\xe0", "jpg"),
        (b"\xff\xd8\xff\xe1", "jpeg"),
        (b"GIF89a", "gif"),
        (b"BM", "bmp"),
        (b"anything", "tga"),
    ],
)
def test_a_picture_is_fine_under_its_own_name_and_not_under_another(head, extension):
    assert fault_of(head, len(head), extension, texture=True) is None
    fault = fault_of(b"\0\1\2\3", 4, extension, texture=True)
    assert (fault is None) == (extension == "tga")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_collada_is_known_in_each_encoding(encoding):
    good = "<?xml version='1.0'?><!-- a <comment> -->\n<COLLADA/>".encode(encoding)
    bad = "<?xml version='1.0'?><!-- a comment --><!DOCTYPE a><COLLADA/>".encode(encoding)
    assert fault_of(good, len(good), "dae") is None
    assert fault_of(bad, len(bad), "dae") is not None


def test_a_doctype_in_a_comment_of_collada_is_none():
    data = b"<!-- <!DOCTYPE a> --><COLLADA/>"
    assert fault_of(data, len(data), "dae") is None


def test_binary_formats_begin_as_they_should():
    glb = b"glTF" + struct.pack("<II", 2, 20) + bytes(8)
    assert fault_of(glb, 20, "glb") is None
    assert fault_of(glb, 20, "gltf") is None
    assert fault_of(glb[:12], 12, "glb") is not None
    assert fault_of(b"ply\nformat ascii 1.0\n", 21, "ply") is None
    assert fault_of(b"format ascii 1.0\n", 17, "ply") is not None
    assert fault_of(b"v 0 0 0\0\0", 9, "obj") is not None


# --- the files that a robot names ----------------------------------------------------------------------------------


def robot(folder, *names):
    shapes = "".join(f'<visual><geometry><mesh filename="{name}"/></geometry></visual>' for name in names)
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="r"><link name="a">{shapes}</link></robot>', encoding="utf-8")
    return subject_of(str(path))


def test_the_answer_is_kept_and_each_name_is_looked_up_once(tmp_path, monkeypatch):
    (tmp_path / "a.stl").write_text("solid a\nfacet\nendsolid\n")
    subject = robot(tmp_path, *["a.stl"] * 20, "b.stl")
    files = named_files(subject)
    assert {name: len(file.uses) for name, file in files.items()} == {"a.stl": 20, "b.stl": 1}
    assert files["a.stl"].found == tmp_path / "a.stl"
    (tmp_path / "a.stl").unlink()
    assert named_files(subject) is files


def test_a_fifo_does_not_block(tmp_path):
    import os

    os.mkfifo(tmp_path / "fifo.stl")
    file = named_files(robot(tmp_path, "fifo.stl"))["fifo.stl"]
    assert isinstance(file.found, str)


def test_nothing_outside_the_package_is_opened(tmp_path):
    from corpus.watched import watch

    package = tmp_path / "package"
    package.mkdir()
    (package / "link.stl").symlink_to("/etc/passwd")
    (tmp_path / "secret.stl").write_text("secret")
    subject = robot(
        package, "link.stl", "../secret.stl", "/etc/passwd", "file:///etc/passwd", "package://../secret.stl"
    )
    with watch() as opened:
        files = named_files(subject)
    assert all(isinstance(file.found, str) for file in files.values())
    assert opened == set()


def test_so_many_names_and_no_more_are_looked_for(tmp_path):
    files = named_files(robot(tmp_path, *[f"{i}.stl" for i in range(MANY + 1)]))
    assert [file.found is None for file in files.values()] == [False] * MANY + [True]
