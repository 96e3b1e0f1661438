"""What touching pairs hold tangentially: sticking, creep and friction."""
