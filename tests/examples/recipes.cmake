example_folder(recipes)

# Each compares its own results with theory.
foreach(name distance_free_energy minimise barostats replicas cells shear dumbbells driven massless respa switched porting)
    example_test(recipes.${name} recipes recipe_${name} --)
endforeach()
