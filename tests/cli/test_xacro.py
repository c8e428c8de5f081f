"""xacro files through the command line, in a fresh process: what another test has imported does not help."""

import subprocess
import sys

XACRO = """<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="length" default="1"/>
  <xacro:macro name="bar" params="name"><link name="${name}"/></xacro:macro>
  <xacro:bar name="base"/><xacro:bar name="tip"/>
  <joint name="turn" type="continuous">
    <origin xyz="$(arg length) 0 0"/><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
  </joint>
</robot>"""


def test_a_xacro_file_is_expanded(tmp_path):
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(XACRO)
    command = [sys.executable, "-m", "kinetostat_cli", "fk", str(path), "-F", "csv", "--xacro-arg", "length:=2.5"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[1].startswith("tip,base,2.5,0.0,0.0,")


def test_a_package_that_is_not_found_is_one_clear_line(tmp_path):
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO.replace("<xacro:arg", '<xacro:include filename="$(find nowhere)/a.xacro"/><xacro:arg', 1))
    run = subprocess.run(
        [sys.executable, "-m", "kinetostat_cli", "fk", str(path)], capture_output=True, text=True, check=False
    )
    assert run.returncode == 3
    assert (
        run.stderr
        == f"kinetostat: error: {path}: xacro asks for package 'nowhere', which is not found (use --package-dir)\n"
    )
