"""What touching pairs hold tangentially: sticking, grazing and friction."""
