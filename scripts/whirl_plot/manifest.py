"""Names of files in the manifest of a run, so that a later run replaces them and nothing else."""
import pathlib


def register(path):
    """Appends the file to `manifest.txt` of its folder; a folder without one belongs to no run."""
    path = pathlib.Path(path)
    manifest = path.parent / "manifest.txt"
    if manifest.exists() and path.name not in manifest.read_text(encoding="utf-8").split("\n"):
        with open(manifest, "a", encoding="utf-8") as f:
            f.write(path.name + "\n")
    return path
