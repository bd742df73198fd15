"""The body under gravity: MuJoCo simulates it, and what moves it are its own joints."""
