"""What is shown: the scene, how bodies are drawn, the page that shows it, and runs kept to be played again."""
